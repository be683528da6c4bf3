// SPDX-License-Identifier: MIT
// Casts vertical rays through a triangle mesh with exact decisions on edges and vertices.
#include "shape/ray_crossings.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace verisim::shape {
namespace {

// Coordinates on the lattice stay below 2^57 (28 bits of cells, 28 bits within a cell, 1 spare), so
// an orientation, a sum of two products of differences, stays below 2^118.
__extension__ using Int128 = __int128;
constexpr int kBitsPerCell = 28;
constexpr std::int64_t kLatticePerCell = std::int64_t{1} << kBitsPerCell;

struct LatticePoint {
  std::int64_t x, y;
};

// Twice the signed area of (a, b, c): > 0 when counter-clockwise.
Int128 orientation(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c) {
  return static_cast<Int128>(b.x - a.x) * (c.y - a.y) -
         static_cast<Int128>(b.y - a.y) * (c.x - a.x);
}

// Whether a counter-clockwise triangle owns the points on its edge a -> b. Of two triangles that
// meet at an edge from either side exactly one does: the edge runs down, or level to the right.
bool owns_edge(const LatticePoint& a, const LatticePoint& b) {
  return b.y < a.y || (b.y == a.y && b.x > a.x);
}

// One triangle seen from above, counter-clockwise.
struct ProjectedTriangle {
  std::array<LatticePoint, 3> corners;
  std::array<double, 3> heights;  // cells
  int turn;
};

std::int64_t to_lattice(double cells) {
  return std::llround(cells * static_cast<double>(kLatticePerCell));
}

std::int64_t center_of_cell(std::int64_t index) {
  return index * kLatticePerCell + kLatticePerCell / 2;
}

// First cell whose centre is at or after the lattice coordinate. (Shifts round down.)
std::int64_t first_center_from(std::int64_t coordinate) {
  return (coordinate + kLatticePerCell / 2 - 1) >> kBitsPerCell;
}

std::int64_t last_center_until(std::int64_t coordinate) {
  return (coordinate - kLatticePerCell / 2) >> kBitsPerCell;
}

struct Span {
  std::int64_t first, last;
};

// Columns that row `y` of the triangle may reach: where the row meets the edges, a little widened,
// since this only saves exact tests and never replaces one.
Span columns_in_row(const ProjectedTriangle& triangle, std::int64_t y, const Span& all) {
  double low = INFINITY;
  double high = -INFINITY;
  for (int corner = 0; corner < 3; ++corner) {
    const LatticePoint& a = triangle.corners[corner];
    const LatticePoint& b = triangle.corners[(corner + 1) % 3];
    if (std::min(a.y, b.y) > y || std::max(a.y, b.y) < y) continue;
    if (a.y == b.y) {
      low = std::min(low, static_cast<double>(std::min(a.x, b.x)));
      high = std::max(high, static_cast<double>(std::max(a.x, b.x)));
      continue;
    }
    const double share = static_cast<double>(y - a.y) / static_cast<double>(b.y - a.y);
    const double x = static_cast<double>(a.x) + share * static_cast<double>(b.x - a.x);
    low = std::min(low, x);
    high = std::max(high, x);
  }
  // Rounding of x is below 2^-20 cells for the largest grid; the margin is 2^-10 cells.
  constexpr double kMargin = static_cast<double>(kLatticePerCell >> 10);
  return {std::max(all.first, first_center_from(static_cast<std::int64_t>(low - kMargin))),
          std::min(all.last, last_center_until(static_cast<std::int64_t>(high + kMargin)))};
}

struct FoundCrossing {
  std::int64_t column;
  Crossing crossing;
};

class CrossingFinder {
 public:
  explicit CrossingFinder(const CellGrid& grid) : grid_(grid) {}

  void add_triangle(ProjectedTriangle triangle) {
    auto& [a, b, c] = triangle.corners;
    const Int128 area = orientation(a, b, c);
    if (area == 0) return;
    // Facing down (clockwise from above) means that a ray going up enters the solid here.
    triangle.turn = area < 0 ? 1 : -1;
    if (area < 0) {
      std::swap(b, c);
      std::swap(triangle.heights[1], triangle.heights[2]);
    }
    const auto [low_x, high_x] = std::minmax({a.x, b.x, c.x});
    const auto [low_y, high_y] = std::minmax({a.y, b.y, c.y});
    const Span columns{std::max<std::int64_t>(0, first_center_from(low_x)),
                       std::min(grid_.num_cells[0] - 1, last_center_until(high_x))};
    const Span rows{std::max<std::int64_t>(0, first_center_from(low_y)),
                    std::min(grid_.num_cells[1] - 1, last_center_until(high_y))};
    if (columns.first > columns.last) return;
    for (std::int64_t j = rows.first; j <= rows.last; ++j) {
      const Span in_row = columns_in_row(triangle, center_of_cell(j), columns);
      for (std::int64_t i = in_row.first; i <= in_row.last; ++i) test_ray(triangle, i, j);
    }
  }

  // Counting sort by column, then each column by height.
  ColumnCrossings take() {
    ColumnCrossings result;
    result.num_ray_tests = num_ray_tests_;
    result.begin.assign(grid_.num_cells[0] * grid_.num_cells[1] + 1, 0);
    for (const FoundCrossing& found : found_) ++result.begin[found.column + 1];
    for (std::size_t c = 1; c < result.begin.size(); ++c) result.begin[c] += result.begin[c - 1];
    result.crossings.resize(found_.size());
    std::vector<std::int64_t> next = result.begin;
    for (const FoundCrossing& found : found_) {
      result.crossings[next[found.column]++] = found.crossing;
    }
    for (std::size_t c = 0; c + 1 < result.begin.size(); ++c) {
      std::sort(result.crossings.begin() + result.begin[c],
                result.crossings.begin() + result.begin[c + 1],
                [](const Crossing& a, const Crossing& b) { return a.height < b.height; });
    }
    return result;
  }

 private:
  void test_ray(const ProjectedTriangle& triangle, std::int64_t i, std::int64_t j) {
    ++num_ray_tests_;
    const LatticePoint ray{center_of_cell(i), center_of_cell(j)};
    double weight_sum = 0;
    double height = 0;
    for (int corner = 0; corner < 3; ++corner) {
      const LatticePoint& from = triangle.corners[corner];
      const LatticePoint& to = triangle.corners[(corner + 1) % 3];
      const Int128 side = orientation(from, to, ray);
      if (side < 0 || (side == 0 && !owns_edge(from, to))) return;
      // The area opposite a corner is its barycentric weight.
      weight_sum += static_cast<double>(side);
      height += static_cast<double>(side) * triangle.heights[(corner + 2) % 3];
    }
    found_.push_back({j * grid_.num_cells[0] + i, {height / weight_sum, triangle.turn}});
  }

  const CellGrid& grid_;
  std::vector<FoundCrossing> found_;
  std::int64_t num_ray_tests_ = 0;
};

}  // namespace

ColumnCrossings find_crossings(const Mesh& mesh, const CellGrid& grid) {
  std::vector<LatticePoint> points;
  std::vector<double> heights;
  points.reserve(mesh.vertices.size());
  heights.reserve(mesh.vertices.size());
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    const Eigen::Vector3d cells = (vertex - grid.origin) / grid.spacing;
    points.push_back({to_lattice(cells.x()), to_lattice(cells.y())});
    heights.push_back(cells.z());
  }
  CrossingFinder finder(grid);
  for (const auto& [a, b, c] : mesh.triangles) {
    finder.add_triangle(
        {{points[a], points[b], points[c]}, {heights[a], heights[b], heights[c]}, 0});
  }
  return finder.take();
}

}  // namespace verisim::shape
