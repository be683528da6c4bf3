// SPDX-License-Identifier: MIT
// Where vertical rays through the columns of a grid cross a triangle mesh.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "shape/mesh.h"

namespace verisim::shape {

/// Cubic cells along the mesh's axes. Cell (i, j, k) has its centre at origin + spacing (i+½, …).
struct CellGrid {
  Eigen::Vector3d origin;                 // m, lowest corner
  double spacing;                         // m, edge of a cell
  std::array<std::int64_t, 3> num_cells;  // each 1 to kMaxCellsPerAxis

  Eigen::Vector3d cell_center(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return origin + spacing * Eigen::Vector3d(static_cast<double>(i) + 0.5,
                                              static_cast<double>(j) + 0.5,
                                              static_cast<double>(k) + 0.5);
  }
};

/// More would overflow the exact integer arithmetic of the ray test.
constexpr std::int64_t kMaxCellsPerAxis = std::int64_t{1} << 28;

struct Crossing {
  double height;  // above the grid's origin along z, in cells
  int turn;       // +1 where the ray enters the solid (going up), -1 where it leaves
};

/// Crossings of all columns, sorted by height within a column.
/// Column c = j * num_cells[0] + i holds crossings [begin[c], begin[c + 1]).
struct ColumnCrossings {
  std::vector<std::int64_t> begin;
  std::vector<Crossing> crossings;
  std::int64_t num_ray_tests;  // exact triangle-column tests made: the work
};

/// One ray upwards through the centre of each (i, j) column.
/// Rays that pass exactly through an edge or a vertex are decided without tolerances: corners are
/// snapped to a lattice of 2^-28 cells, on which orientation is computed exactly, and a point on an
/// edge belongs to the triangle on one fixed side (half-open rule, as when filling polygons on a
/// screen). This is the same as moving every ray by an infinitely small step first to +x, then +y,
/// so a closed mesh gives every column an even number of crossings. Triangles parallel to the rays
/// have no area in projection and are skipped: their neighbours carry the crossing.
/// The grid must span the mesh in x and y. Cost: triangles + rows they touch + crossings (sorted).
ColumnCrossings find_crossings(const Mesh& mesh, const CellGrid& grid);

}  // namespace verisim::shape
