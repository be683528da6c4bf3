// SPDX-License-Identifier: MIT
// An indexed triangle mesh, the common currency of the shape folder.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace verisim::shape {

/// Triangles wind counter-clockwise seen from outside (outward normals by the right-hand rule).
struct Mesh {
  std::vector<Eigen::Vector3d> vertices;      // m, mesh frame
  std::vector<std::array<int, 3>> triangles;  // indices into vertices
};

}  // namespace verisim::shape
