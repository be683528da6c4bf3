// SPDX-License-Identifier: MIT
// Fills meshes by ray parity, boxes by even spacing, and balls by themselves.
#include "shape/fill_particles.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "shape/extents.h"
#include "shape/ray_crossings.h"

namespace verisim::shape {
namespace {

void require_positive(double spacing) {
  if (std::isfinite(spacing) && spacing > 0) return;
  std::ostringstream message;
  message << "particle size " << spacing << " m is not a positive number\nhint: use a length in m";
  throw FillError(message.str());
}

[[noreturn]] void refuse_count(double spacing, const std::string& needed, std::int64_t limit) {
  std::ostringstream message;
  message << "particle size " << spacing << " m needs " << needed << ", more than the "
          << "limit of " << limit << " particles allows\nhint: use larger particles";
  throw FillError(message.str());
}

CellGrid grid_over(const Mesh& mesh, double spacing, std::int64_t max_num_particles) {
  const Eigen::AlignedBox3d box = bounding_box(mesh);
  // Without the slack a length of 3 cells that rounding made a hair longer would get 4 cells, and
  // cell centres on its faces. The slack exceeds the 32-bit rounding of loaded coordinates.
  constexpr double kRoundingSlack = 1e-6;
  const Eigen::Vector3d counts =
      (box.sizes() / spacing * (1 - kRoundingSlack)).array().ceil().max(1.0);
  const double num_columns = counts.x() * counts.y();
  if (!(num_columns <= 4.0 * static_cast<double>(max_num_particles)) ||
      !(counts.maxCoeff() <= static_cast<double>(kMaxCellsPerAxis))) {
    std::ostringstream needed;
    needed << "a grid of " << counts.x() << " x " << counts.y() << " x " << counts.z() << " cells";
    refuse_count(spacing, needed.str(), max_num_particles);
  }
  CellGrid grid;
  grid.spacing = spacing;
  grid.origin = box.center() - 0.5 * spacing * counts;
  for (int axis = 0; axis < 3; ++axis) {
    grid.num_cells[axis] = static_cast<std::int64_t>(counts[axis]);
  }
  return grid;
}

// Cells [first, end) of a column whose centres lie at or above `bottom` and below `top` (cells).
struct CellRun {
  std::int64_t first, end;
  std::int64_t size() const { return end - first; }
};

CellRun cells_between(double bottom, double top, std::int64_t num_cells) {
  const auto first_from = [num_cells](double height) {
    return static_cast<std::int64_t>(
        std::clamp(std::ceil(height - 0.5), 0.0, static_cast<double>(num_cells)));
  };
  return {first_from(bottom), first_from(top)};
}

struct ColumnRuns {
  std::vector<CellRun> inside;
  std::int64_t num_overlapping_cells;
  bool is_odd;
};

// Inside from each crossing of even rank to the next. The winding number, which counts entries less
// exits, must be 1 there and 0 outside; anything else means that surfaces overlap.
void find_runs(const ColumnCrossings& found, std::int64_t column, std::int64_t num_cells,
               ColumnRuns& runs) {
  runs.inside.clear();
  runs.num_overlapping_cells = 0;
  const std::int64_t begin = found.begin[column];
  const std::int64_t end = found.begin[column + 1];
  runs.is_odd = (end - begin) % 2 != 0;
  int winding = 0;
  for (std::int64_t c = begin; c + 1 < end; ++c) {
    winding += found.crossings[c].turn;
    const CellRun run =
        cells_between(found.crossings[c].height, found.crossings[c + 1].height, num_cells);
    if (run.size() <= 0) continue;
    if ((c - begin) % 2 == 0) runs.inside.push_back(run);
    if (winding != 0 && winding != 1) runs.num_overlapping_cells += run.size();
  }
}

double axis_count(double edge, double spacing) { return std::max(1.0, std::round(edge / spacing)); }

// Centres of `count` particles that touch both ends of an edge centred on 0.
double position_on_axis(std::int64_t index, std::int64_t count, double edge, double radius) {
  if (count == 1) return 0;
  const double share = static_cast<double>(index) / static_cast<double>(count - 1);
  return (2 * share - 1) * (0.5 * edge - radius);
}

}  // namespace

ParticleFill fill_mesh(const Mesh& mesh, double spacing, std::int64_t max_num_particles) {
  require_positive(spacing);
  const CellGrid grid = grid_over(mesh, spacing, max_num_particles);
  const ColumnCrossings found = find_crossings(mesh, grid);
  const auto [num_x, num_y, num_z] = grid.num_cells;

  ParticleFill fill;
  fill.radius = 0.5 * spacing;
  fill.num_ray_tests = found.num_ray_tests;
  ColumnRuns runs;

  // Count first, so that a too fine size is refused before its memory is asked for.
  std::int64_t num_particles = 0;
  for (std::int64_t column = 0; column < num_x * num_y; ++column) {
    find_runs(found, column, num_z, runs);
    fill.num_odd_columns += runs.is_odd;
    fill.num_overlapping_cells += runs.num_overlapping_cells;
    for (const CellRun& run : runs.inside) num_particles += run.size();
  }
  if (num_particles > max_num_particles) {
    refuse_count(spacing, std::to_string(num_particles) + " particles", max_num_particles);
  }
  if (num_particles == 0) {
    std::ostringstream message;
    message << "particle size " << spacing << " m leaves a body of smallest extent "
            << smallest_extent(mesh) << " m without particles\nhint: use smaller particles";
    throw FillError(message.str());
  }

  fill.centers.reserve(num_particles);
  for (std::int64_t column = 0; column < num_x * num_y; ++column) {
    find_runs(found, column, num_z, runs);
    for (const CellRun& run : runs.inside) {
      for (std::int64_t k = run.first; k < run.end; ++k) {
        fill.centers.push_back(grid.cell_center(column % num_x, column / num_x, k));
      }
    }
  }
  return fill;
}

ParticleFill fill_box(const Eigen::Vector3d& edges, double spacing,
                      std::int64_t max_num_particles) {
  require_positive(spacing);
  const Eigen::Vector3d wanted = edges / spacing;
  if (!(wanted.cwiseMax(1.0).prod() <= 2.0 * static_cast<double>(max_num_particles))) {
    std::ostringstream needed;
    needed << "about " << wanted.cwiseMax(1.0).prod() << " particles";
    refuse_count(spacing, needed.str(), max_num_particles);
  }
  double diameter = INFINITY;
  for (int axis = 0; axis < 3; ++axis) {
    diameter = std::min(diameter, edges[axis] / axis_count(edges[axis], spacing));
  }
  std::array<std::int64_t, 3> counts{};
  for (int axis = 0; axis < 3; ++axis) {
    counts[axis] = static_cast<std::int64_t>(axis_count(edges[axis], diameter));
    // The slack is for rounding only: an edge that one particle spans to 1e-12 keeps one.
    if (counts[axis] == 1 && edges[axis] > diameter * (1 + 1e-12)) counts[axis] = 2;
  }
  const std::int64_t num_particles = counts[0] * counts[1] * counts[2];
  if (num_particles > max_num_particles) {
    refuse_count(spacing, std::to_string(num_particles) + " particles", max_num_particles);
  }

  ParticleFill fill;
  fill.radius = 0.5 * diameter;
  fill.centers.reserve(num_particles);
  for (std::int64_t j = 0; j < counts[1]; ++j) {
    for (std::int64_t i = 0; i < counts[0]; ++i) {
      for (std::int64_t k = 0; k < counts[2]; ++k) {
        fill.centers.emplace_back(position_on_axis(i, counts[0], edges.x(), fill.radius),
                                  position_on_axis(j, counts[1], edges.y(), fill.radius),
                                  position_on_axis(k, counts[2], edges.z(), fill.radius));
      }
    }
  }
  return fill;
}

ParticleFill fill_sphere(double radius) {
  ParticleFill fill;
  fill.centers = {Eigen::Vector3d::Zero()};
  fill.radius = radius;
  return fill;
}

}  // namespace verisim::shape
