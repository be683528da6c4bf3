// SPDX-License-Identifier: MIT
// Finds overlapping pairs among spheres of any sizes: sorted cells, one grid per power of two.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace verisim::dem {

/// Cell coordinates at one level. 64 bits: cells of a micrometre reach beyond 1e12 m.
struct Cell {
  int level;
  std::int64_t z, y, x;
  friend auto operator<=>(const Cell&, const Cell&) = default;
};

struct SphereGridItem {
  Eigen::Vector3d position;  // m
  double radius;             // m, > 0
  int id;                    // the caller's, unique
  Cell cell;                 // set by sort_into_cells
};

/// Radii may differ by up to 2^31; beyond that, small spheres share the cells of larger ones.
constexpr int kMaxLevels = 32;

/// Spheres sorted by (level, z, y, x, id). Memory is one item per sphere, wherever they lie.
struct SphereGrid {
  struct Level {
    int level;
    double cell_size;        // m, at least twice the radius of each sphere on this level
    std::size_t begin, end;  // items
  };
  std::vector<SphereGridItem> items;
  std::vector<Level> levels;  // occupied ones, fine to coarse
};

/// Assigns cells and sorts `grid.items`, which the caller has filled.
void sort_into_cells(SphereGrid& grid);

/// Calls visit(i, j), i < j positions in the sorted items, for every pair closer than the sum of
/// radii (and no other), by rising i and for each i by rising j.
template <class Visit>
void for_each_close_pair(const SphereGrid& grid, const Visit& visit);

}  // namespace verisim::dem

#include "dem/sphere_grid_inl.h"
