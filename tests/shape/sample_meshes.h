// SPDX-License-Identifier: MIT
// Closed meshes and random placements that several shape tests use.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "shape/mesh.h"

namespace verisim::shape {

/// Torus about z: ring radius `ring`, tube radius `tube`, num_u x num_v quadrilaterals, halved.
inline Mesh torus_mesh(double ring, double tube, int num_u, int num_v) {
  Mesh mesh;
  const double turn = 2 * std::numbers::pi;
  for (int u = 0; u < num_u; ++u) {
    for (int v = 0; v < num_v; ++v) {
      const double radius = ring + tube * std::cos(turn * v / num_v);
      mesh.vertices.emplace_back(radius * std::cos(turn * u / num_u),
                                 radius * std::sin(turn * u / num_u),
                                 tube * std::sin(turn * v / num_v));
      const int u1 = (u + 1) % num_u * num_v, v1 = (v + 1) % num_v, u0 = u * num_v;
      mesh.triangles.push_back({u0 + v, u1 + v, u1 + v1});
      mesh.triangles.push_back({u0 + v, u1 + v1, u0 + v1});
    }
  }
  return mesh;
}

/// Octahedron with its six corners at distance 1 on the axes.
inline Mesh octahedron_mesh() {
  return {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

/// Both meshes as one, without joining anything.
inline Mesh merged(Mesh first, const Mesh& second) {
  const int offset = static_cast<int>(first.vertices.size());
  first.vertices.insert(first.vertices.end(), second.vertices.begin(), second.vertices.end());
  for (const auto& [a, b, c] : second.triangles) {
    first.triangles.push_back({a + offset, b + offset, c + offset});
  }
  return first;
}

inline Mesh moved(Mesh mesh, const Eigen::Quaterniond& turn, const Eigen::Vector3d& shift) {
  for (Eigen::Vector3d& vertex : mesh.vertices) vertex = turn * vertex + shift;
  return mesh;
}

/// Uniformly distributed rotation from a seeded generator.
inline Eigen::Quaterniond random_rotation(std::mt19937& rng) {
  std::normal_distribution<double> normal;
  Eigen::Quaterniond q(normal(rng), normal(rng), normal(rng), normal(rng));
  return q.normalized();
}

}  // namespace verisim::shape
