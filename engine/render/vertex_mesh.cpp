// SPDX-License-Identifier: MIT
// Normals by crease angle, and the unit sphere.
#include "render/vertex_mesh.h"

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <tuple>

namespace verisim::render {
namespace {

const double kCreaseCosine = std::cos(55 * EIGEN_PI / 180);

struct Corner {
  std::size_t triangle;
  double angle;  // rad, weight of this triangle's normal at the corner
};

double corner_angle(const Eigen::Vector3d& at, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d u = a - at, v = b - at;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

/// Collects vertices, giving equal ones one index.
class VertexPool {
 public:
  std::uint32_t add(int position_index, const Vertex& vertex) {
    const auto key =
        std::make_tuple(position_index, vertex.normal.x(), vertex.normal.y(), vertex.normal.z());
    const auto [found, is_new] =
        indices_.try_emplace(key, static_cast<std::uint32_t>(vertices.size()));
    if (is_new) vertices.push_back(vertex);
    return found->second;
  }
  std::vector<Vertex> vertices;

 private:
  std::map<std::tuple<int, float, float, float>, std::uint32_t> indices_;
};

}  // namespace

VertexMesh with_normals(const TriangleMesh& mesh, const Eigen::Vector3d& offset) {
  std::vector<Eigen::Vector3d> face_normals;
  std::vector<std::vector<Corner>> corners(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& triangle = mesh.triangles[t];
    const auto point = [&](int k) { return mesh.positions[triangle[k % 3]]; };
    face_normals.push_back((point(1) - point(0)).cross(point(2) - point(0)).normalized());
    for (int k = 0; k < 3; ++k) {
      corners[triangle[k]].push_back({t, corner_angle(point(k), point(k + 1), point(k + 2))});
    }
  }
  VertexPool pool;
  VertexMesh result;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const int index : mesh.triangles[t]) {
      Eigen::Vector3d normal = Eigen::Vector3d::Zero();
      for (const Corner& corner : corners[index]) {
        const Eigen::Vector3d& other = face_normals[corner.triangle];
        if (other.dot(face_normals[t]) >= kCreaseCosine) normal += corner.angle * other;
      }
      const Eigen::Vector3d position = mesh.positions[index] + offset;
      result.indices.push_back(
          pool.add(index, {position.cast<float>(), normal.normalized().cast<float>()}));
    }
  }
  result.vertices = std::move(pool.vertices);
  return result;
}

VertexMesh geodesic_sphere(int frequency) {
  const double golden = (1 + std::sqrt(5.0)) / 2;
  const std::array<Eigen::Vector3d, 12> corners{{{-1, golden, 0},
                                                 {1, golden, 0},
                                                 {-1, -golden, 0},
                                                 {1, -golden, 0},
                                                 {0, -1, golden},
                                                 {0, 1, golden},
                                                 {0, -1, -golden},
                                                 {0, 1, -golden},
                                                 {golden, 0, -1},
                                                 {golden, 0, 1},
                                                 {-golden, 0, -1},
                                                 {-golden, 0, 1}}};
  const std::array<std::array<int, 3>, 20> faces{
      {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
       {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
       {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  // An edge of the outline spans about 63.4 degrees / frequency; its middle sags by half of
  // (1 - cos) on either side of the true circle when corners stand out by the other half.
  const double half_angle = std::atan(2.0) / frequency / 2;
  const double outward = 2 / (1 + std::cos(half_angle));
  TriangleMesh mesh;
  std::map<std::tuple<long, long, long>, int> known;
  const auto vertex = [&](const Eigen::Vector3d& flat) {
    const Eigen::Vector3d unit = flat.normalized();
    const Eigen::Vector3d rounded = (unit * 1e6).array().round();
    const auto key = std::make_tuple(static_cast<long>(rounded.x()), static_cast<long>(rounded.y()),
                                     static_cast<long>(rounded.z()));
    const auto [found, is_new] = known.try_emplace(key, static_cast<int>(mesh.positions.size()));
    if (is_new) mesh.positions.push_back(unit);
    return found->second;
  };
  for (const auto& face : faces) {
    const Eigen::Vector3d &a = corners[face[0]], &b = corners[face[1]], &c = corners[face[2]];
    const auto at = [&](int i, int j) {
      return vertex(a + (b - a) * i / frequency + (c - a) * j / frequency);
    };
    for (int i = 0; i < frequency; ++i) {
      for (int j = 0; i + j < frequency; ++j) {
        mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        if (i + j + 1 < frequency) {
          mesh.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        }
      }
    }
  }
  VertexMesh result;
  for (const Eigen::Vector3d& unit : mesh.positions) {
    result.vertices.push_back({(unit * outward).cast<float>(), unit.cast<float>()});
  }
  for (const auto& triangle : mesh.triangles) {
    for (const int index : triangle) result.indices.push_back(static_cast<std::uint32_t>(index));
  }
  return result;
}

}  // namespace verisim::render
