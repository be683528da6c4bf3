// SPDX-License-Identifier: MIT
// Signed distance to the surface of a closed mesh, at the nodes of a regular grid.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "shape/mesh.h"
#include "shape/mesh_error.h"

namespace verisim::shape {

/// Node (i, j, k) lies at origin + spacing (i, j, k); x runs fastest in `values`.
struct DistanceGrid {
  Eigen::Vector3d origin;     // m, mesh frame, lowest node
  double spacing;             // m, edge of a cell
  std::array<int, 3> counts;  // nodes per axis
  std::vector<float> values;  // m, negative inside

  Eigen::Vector3d node(int i, int j, int k) const {
    return origin + spacing * Eigen::Vector3d(i, j, k);
  }
};

/// 16 MB, and a few seconds to fill.
constexpr std::int64_t kMaxNumGridNodes = 4'000'000;

/// The spacing (m) that suits a mesh: a 24th of its smallest extent, coarser where that would need
/// more than 128 cells along the longest; but at least 4 cells across the smallest extent (else
/// both sides of a plate share cells) as far as kMaxNumGridNodes allows.
double default_grid_spacing(const Mesh& mesh);

/// The grid is centred on the bounding box and leaves two cells of margin around it. Values are the
/// exact distances to the polyhedron, rounded to 32 bits, so the trilinear interpolant is off by
/// O(spacing^2 * curvature) where the distance is smooth and by at most about half a spacing at
/// sharp edges. A node is inside where the surface winds around it: by crossings of the vertical
/// ray through it (ray_crossings.h), robust where rays hit edges; parts of the mesh that overlap
/// are inside.
/// Throws MeshError for a mesh that is no solid (check_mesh.h), a spacing that is not a positive
/// number, and more than kMaxNumGridNodes nodes. Cost: nodes x log(triangles), 1 to 5 us a node.
DistanceGrid make_distance_grid(const Mesh& mesh, double spacing);

}  // namespace verisim::shape
