// SPDX-License-Identifier: MIT
// The walk over neighbouring cells; included by sphere_grid.h.
#pragma once

namespace verisim::dem {
namespace sphere_grid_detail {

/// Cells (z, y, x - 1 .. x + 1) of one level: consecutive in the sorted items.
struct RowRange {
  std::size_t begin, end;
};

std::int64_t cell_coordinate(double position, double cell_size);
/// First item at or after `cell`, within [begin, end).
std::size_t lower_bound(const SphereGrid& grid, std::size_t begin, std::size_t end,
                        const Cell& cell);

inline bool is_close(const SphereGridItem& a, const SphereGridItem& b) {
  const double reach = a.radius + b.radius;
  return (a.position - b.position).squaredNorm() < reach * reach;
}

template <class Visit>
void visit_range(const SphereGrid& grid, std::size_t i, RowRange range, const Visit& visit) {
  for (std::size_t j = range.begin; j < range.end; ++j) {
    if (is_close(grid.items[i], grid.items[j])) visit(i, j);
  }
}

/// The half stencil on one level: rest of the own row, then the four rows that follow it.
/// Both ends of each row only move forward while i does, so no search is needed.
template <class Visit>
void visit_own_level(const SphereGrid& grid, const SphereGrid::Level& level, std::size_t i,
                     std::array<RowRange, 5>& rows, const Visit& visit) {
  constexpr std::array<std::array<int, 2>, 5> kRows = {{{0, 0}, {0, 1}, {1, -1}, {1, 0}, {1, 1}}};
  const Cell& cell = grid.items[i].cell;
  for (std::size_t row = 0; row < kRows.size(); ++row) {
    const std::int64_t z = cell.z + kRows[row][0], y = cell.y + kRows[row][1];
    const Cell first{cell.level, z, y, cell.x - 1}, last{cell.level, z, y, cell.x + 1};
    RowRange& range = rows[row];
    while (range.begin < level.end && grid.items[range.begin].cell < first) ++range.begin;
    if (range.end < range.begin) range.end = range.begin;
    while (range.end < level.end && grid.items[range.end].cell <= last) ++range.end;
    visit_range(grid, i, {row == 0 ? i + 1 : range.begin, range.end}, visit);
  }
}

/// All nine rows around i on a coarser level; searched only when i's cell there changes.
struct CoarseRows {
  bool known = false;
  Cell cell{};
  std::array<RowRange, 9> rows{};
};

template <class Visit>
void visit_coarser_level(const SphereGrid& grid, const SphereGrid::Level& level, std::size_t i,
                         CoarseRows& around, const Visit& visit) {
  const Eigen::Vector3d& p = grid.items[i].position;
  const Cell cell{level.level, cell_coordinate(p.z(), level.cell_size),
                  cell_coordinate(p.y(), level.cell_size), cell_coordinate(p.x(), level.cell_size)};
  if (!around.known || around.cell != cell) {
    around.known = true;
    around.cell = cell;
    std::size_t row = 0;
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy, ++row) {
        const std::int64_t z = cell.z + dz, y = cell.y + dy;
        const auto find = [&](std::int64_t x) {
          return lower_bound(grid, level.begin, level.end, {cell.level, z, y, x});
        };
        around.rows[row] = {find(cell.x - 1), find(cell.x + 2)};
      }
    }
  }
  for (const RowRange& range : around.rows) visit_range(grid, i, range, visit);
}

}  // namespace sphere_grid_detail

template <class Visit>
void for_each_close_pair(const SphereGrid& grid, const Visit& visit) {
  namespace detail = sphere_grid_detail;
  for (std::size_t own = 0; own < grid.levels.size(); ++own) {
    const SphereGrid::Level& level = grid.levels[own];
    std::array<detail::RowRange, 5> rows;
    rows.fill({level.begin, level.begin});
    std::array<detail::CoarseRows, kMaxLevels> coarse{};
    for (std::size_t i = level.begin; i < level.end; ++i) {
      detail::visit_own_level(grid, level, i, rows, visit);
      for (std::size_t other = own + 1; other < grid.levels.size(); ++other) {
        detail::visit_coarser_level(grid, grid.levels[other], i, coarse[other], visit);
      }
    }
  }
}

}  // namespace verisim::dem
