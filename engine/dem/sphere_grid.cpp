// SPDX-License-Identifier: MIT
// Finds overlapping pairs among spheres of any sizes: sorted cells, one grid per power of two.
#include "dem/sphere_grid.h"

#include <algorithm>
#include <cmath>

namespace verisim::dem {
namespace {

/// Radius for which the finest level is made.
double finest_radius(const std::vector<SphereGridItem>& items) {
  double least = items.front().radius, greatest = least;
  for (const SphereGridItem& item : items) {
    least = std::min(least, item.radius);
    greatest = std::max(greatest, item.radius);
  }
  return std::max(least, std::ldexp(greatest, -(kMaxLevels - 1)));
}

// Cells are wider than the spheres need, so that like bodies, whose radii differ by the margins of
// their speeds, share a level: searching a second level costs more than a quarter more width.
double cell_size_of(double finest, int level) { return std::ldexp(1.25 * 2 * finest, level); }

int level_of(double radius, double finest) {
  int level = 0;
  while (level < kMaxLevels - 1 && cell_size_of(finest, level) < 2 * radius) ++level;
  return level;
}

bool comes_before(const SphereGridItem& a, const SphereGridItem& b) {
  return a.cell != b.cell ? a.cell < b.cell : a.id < b.id;
}

}  // namespace

namespace sphere_grid_detail {

std::int64_t cell_coordinate(double position, double cell_size) {
  // Far beyond any scene; keeps the conversion defined. All that lie there share the last cell.
  constexpr double kLimit = 4e18;
  return static_cast<std::int64_t>(std::floor(std::clamp(position / cell_size, -kLimit, kLimit)));
}

std::size_t lower_bound(const SphereGrid& grid, std::size_t begin, std::size_t end,
                        const Cell& cell) {
  const auto first = grid.items.begin();
  const auto found = std::lower_bound(
      first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(end), cell,
      [](const SphereGridItem& item, const Cell& wanted) { return item.cell < wanted; });
  return static_cast<std::size_t>(found - first);
}

}  // namespace sphere_grid_detail

void sort_into_cells(SphereGrid& grid) {
  grid.levels.clear();
  if (grid.items.empty()) return;
  const double finest = finest_radius(grid.items);
  for (SphereGridItem& item : grid.items) {
    const int level = level_of(item.radius, finest);
    const double size = cell_size_of(finest, level);
    item.cell = {level, sphere_grid_detail::cell_coordinate(item.position.z(), size),
                 sphere_grid_detail::cell_coordinate(item.position.y(), size),
                 sphere_grid_detail::cell_coordinate(item.position.x(), size)};
  }
  std::sort(grid.items.begin(), grid.items.end(), comes_before);
  for (std::size_t i = 0; i < grid.items.size(); ++i) {
    const int level = grid.items[i].cell.level;
    if (grid.levels.empty() || grid.levels.back().level != level) {
      grid.levels.push_back({level, cell_size_of(finest, level), i, i});
    }
    grid.levels.back().end = i + 1;
  }
}

}  // namespace verisim::dem
