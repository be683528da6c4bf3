// SPDX-License-Identifier: MIT
// Searches the nearest triangle of every node, and takes the sign from vertical rays.
#include "shape/distance_grid.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "shape/check_mesh.h"
#include "shape/extents.h"
#include "shape/ray_crossings.h"
#include "shape/triangle_tree.h"

namespace verisim::shape {
namespace {

constexpr double kMarginCells = 2;  // each side: gradients stay defined a little outside

// Nodes per axis.
Eigen::Vector3d node_counts(const Eigen::Vector3d& sizes, double spacing) {
  // Without the slack, a size of 24 cells that rounding made a hair longer would get 25.
  constexpr double kRoundingSlack = 1e-6;
  const Eigen::Array3d cells = (sizes / spacing * (1 - kRoundingSlack)).array().ceil().max(1.0);
  return cells + 2 * kMarginCells + 1;
}

DistanceGrid empty_grid(const Mesh& mesh, double spacing) {
  const Eigen::AlignedBox3d box = bounding_box(mesh);
  const Eigen::Vector3d counts = node_counts(box.sizes(), spacing);
  if (!(spacing > 0) || !(counts.prod() <= static_cast<double>(kMaxNumGridNodes))) {
    std::ostringstream message;
    message << "a distance grid of spacing " << spacing << " m over " << box.sizes().x() << " x "
            << box.sizes().y() << " x " << box.sizes().z() << " m has more than the "
            << kMaxNumGridNodes << " nodes that are allowed\nhint: use a spacing of "
            << default_grid_spacing(mesh) << " m";
    throw MeshError(message.str());
  }
  DistanceGrid grid;
  grid.spacing = spacing;
  grid.origin = box.center() - 0.5 * spacing * (counts.array() - 1).matrix();
  for (int axis = 0; axis < 3; ++axis) grid.counts[axis] = static_cast<int>(counts[axis]);
  grid.values.resize(static_cast<std::size_t>(counts.prod()));
  return grid;
}

// +1 or -1 for each node of a column, from its crossings in order of height (in cells above the
// node of index -1/2, as CellGrid counts).
class ColumnSide {
 public:
  ColumnSide(const Crossing* next, const Crossing* end) : next_(next), end_(end) {}
  // Nodes are asked for in rising order.
  float of_node(int k) {
    while (next_ != end_ && next_->height <= k + 0.5) winding_ += (next_++)->turn;
    return winding_ == 0 ? 1.0F : -1.0F;
  }

 private:
  const Crossing* next_;
  const Crossing* end_;
  int winding_ = 0;
};

void set_signs(const Mesh& mesh, DistanceGrid& grid) {
  const auto [nx, ny, nz] = grid.counts;
  // Cells whose centres are the nodes.
  const CellGrid cells{
      grid.origin - Eigen::Vector3d::Constant(0.5 * grid.spacing), grid.spacing, {nx, ny, nz}};
  const ColumnCrossings found = find_crossings(mesh, cells);
  const std::size_t num_columns = static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny);
  for (std::size_t column = 0; column < num_columns; ++column) {
    const Crossing* crossings = found.crossings.data();
    ColumnSide side(crossings + found.begin[column], crossings + found.begin[column + 1]);
    for (int k = 0; k < nz; ++k) {
      grid.values[static_cast<std::size_t>(k) * num_columns + column] *= side.of_node(k);
    }
  }
}

}  // namespace

double default_grid_spacing(const Mesh& mesh) {
  const Eigen::Vector3d sizes = bounding_box(mesh).sizes();
  double spacing = std::max(sizes.minCoeff() / 24, sizes.maxCoeff() / 128);
  spacing = std::min(spacing, sizes.minCoeff() / 4);
  while (node_counts(sizes, spacing).prod() > static_cast<double>(kMaxNumGridNodes)) {
    spacing *= 1.02;
  }
  return spacing;
}

DistanceGrid make_distance_grid(const Mesh& mesh, double spacing) {
  require_solid(mesh, "mesh for a distance grid");
  DistanceGrid grid = empty_grid(mesh, spacing);
  const TriangleTree tree(mesh);
  const auto [nx, ny, nz] = grid.counts;
  int nearest = 0;
  std::size_t n = 0;
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i, ++n) {
        // The neighbour's triangle is a good guess; across the end of a row it merely costs time.
        const NearestPoint found = tree.nearest(grid.node(i, j, k), nearest);
        nearest = found.triangle;
        grid.values[n] = static_cast<float>(std::sqrt(found.squared_distance));
      }
    }
  }
  set_signs(mesh, grid);
  return grid;
}

}  // namespace verisim::shape
