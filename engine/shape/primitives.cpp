// SPDX-License-Identifier: MIT
// Makes closed triangle meshes of boxes and balls.
#include "shape/primitives.h"

#include <cassert>
#include <map>
#include <numbers>
#include <utility>

namespace verisim::shape {

Mesh box_mesh(const Eigen::Vector3d& edges) {
  Mesh mesh;
  // Vertex i has x, y, z at the upper face where bit 0, 1, 2 of i is set.
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d corner(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
    mesh.vertices.push_back(corner.cwiseProduct(edges));
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

namespace {

Mesh unit_icosahedron() {
  constexpr double kGolden = std::numbers::phi;
  Mesh mesh;
  mesh.vertices = {{-1, kGolden, 0}, {1, kGolden, 0}, {-1, -kGolden, 0}, {1, -kGolden, 0},
                   {0, -1, kGolden}, {0, 1, kGolden}, {0, -1, -kGolden}, {0, 1, -kGolden},
                   {kGolden, 0, -1}, {kGolden, 0, 1}, {-kGolden, 0, -1}, {-kGolden, 0, 1}};
  for (Eigen::Vector3d& vertex : mesh.vertices) vertex.normalize();
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  return mesh;
}

// Splits each triangle into four; new vertices are pushed out to the unit sphere.
Mesh split_on_sphere(Mesh mesh) {
  std::map<std::pair<int, int>, int> middles;
  const auto middle_of = [&](int a, int b) {
    const auto [entry, is_new] =
        middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
    return entry->second;
  };
  std::vector<std::array<int, 3>> finer;
  finer.reserve(4 * mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const int ab = middle_of(a, b);
    const int bc = middle_of(b, c);
    const int ca = middle_of(c, a);
    finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  mesh.triangles = std::move(finer);
  return mesh;
}

}  // namespace

Mesh sphere_mesh(double radius, int subdivisions) {
  assert(subdivisions >= 0 && subdivisions <= 8);
  Mesh mesh = unit_icosahedron();
  for (int i = 0; i < subdivisions; ++i) mesh = split_on_sphere(std::move(mesh));
  for (Eigen::Vector3d& vertex : mesh.vertices) vertex *= radius;
  return mesh;
}

}  // namespace verisim::shape
