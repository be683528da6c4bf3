// SPDX-License-Identifier: MIT
// The interpolated distance has its own exact gradient, so that forces along it keep energy.
#include "dem/distance_field.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>

using namespace verisim::dem;

namespace {

// Distance to a ball of radius 1, which is no polynomial.
DistanceField ball_field(double spacing) {
  const int count = static_cast<int>(std::ceil(2 / spacing)) + 5;
  DistanceField field;
  field.spacing = spacing;
  field.counts = {count, count + 1, count + 2};
  field.origin_b = Eigen::Vector3d::Constant(-1 - 2.1 * spacing);
  for (int k = 0; k < count + 2; ++k) {
    for (int j = 0; j < count + 1; ++j) {
      for (int i = 0; i < count; ++i) {
        const Eigen::Vector3d node = field.origin_b + spacing * Eigen::Vector3d(i, j, k);
        field.values.push_back(static_cast<float>(node.norm() - 1));
      }
    }
  }
  return field;
}

}  // namespace

TEST_CASE("the_gradient_is_the_derivative_of_the_interpolated_distance") {
  const DistanceField field = ball_field(0.17);
  std::mt19937 rng(7);
  std::uniform_int_distribution<int> cell(0, 13);
  std::uniform_real_distribution<double> inside(0.01, 0.99);
  double worst = 0;
  constexpr double kStep = 1e-4;
  for (int n = 0; n < 1000; ++n) {
    const Eigen::Vector3d cells(cell(rng) + inside(rng), cell(rng) + inside(rng),
                                cell(rng) + inside(rng));
    const Eigen::Vector3d p = field.origin_b + field.spacing * cells;
    const DistanceValue at = distance_at(field, p);
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
      // Linear along an axis, so the central difference has no truncation error.
      const double slope =
          (distance_at(field, p + step).value - distance_at(field, p - step).value) / (2 * kStep);
      worst = std::max(worst, std::abs(slope - at.gradient[axis]));
    }
  }
  CHECK(worst < 1e-11);  // measured 2.7e-12
}

TEST_CASE("the_interpolated_distance_is_continuous_and_hits_the_nodes") {
  const DistanceField field = ball_field(0.25);
  const auto [nx, ny, nz] = field.counts;
  double worst = 0;
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        const Eigen::Vector3d node = field.origin_b + field.spacing * Eigen::Vector3d(i, j, k);
        const double value = field.values[(static_cast<std::size_t>(k) * ny + j) * nx + i];
        for (double step : {-1e-9, 0.0, 1e-9}) {
          const Eigen::Vector3d p = node + Eigen::Vector3d::Constant(step);
          if (step != 0 && (i * j * k == 0 || i == nx - 1 || j == ny - 1 || k == nz - 1)) continue;
          worst = std::max(worst, std::abs(distance_at(field, p).value - value));
        }
      }
    }
  }
  CHECK(worst < 1e-8);  // measured 2.8e-9: three steps of 1e-9
}

TEST_CASE("interpolation_error_falls_with_the_square_of_the_spacing") {
  std::vector<double> errors;
  for (double spacing : {0.1, 0.05}) {
    const DistanceField field = ball_field(spacing);
    std::mt19937 rng(9);
    std::normal_distribution<double> normal;
    double worst = 0;
    for (int n = 0; n < 5000; ++n) {
      const Eigen::Vector3d p = Eigen::Vector3d(normal(rng), normal(rng), normal(rng)).normalized();
      worst = std::max(worst, std::abs(distance_at(field, p).value));
    }
    errors.push_back(worst);
  }
  CHECK(errors[1] < 7e-4);             // measured 6.2e-4; bound 2 spacing^2 / 8
  CHECK(errors[0] / errors[1] > 3.6);  // measured 4.01
}

TEST_CASE("outside_the_grid_the_value_is_a_lower_bound_with_its_own_gradient") {
  const DistanceField field = ball_field(0.3);
  std::mt19937 rng(11);
  std::uniform_real_distribution<double> place(-4, 4);
  const Eigen::Vector3d high =
      field.origin_b +
      field.spacing *
          (Eigen::Vector3d(field.counts[0], field.counts[1], field.counts[2]).array() - 1).matrix();
  int num_outside = 0;
  double least_share = 1, worst_slope = 0;
  for (int n = 0; n < 5000; ++n) {
    const Eigen::Vector3d p(place(rng), place(rng), place(rng));
    const bool inside =
        (p.array() >= field.origin_b.array()).all() && (p.array() <= high.array()).all();
    if (inside) continue;
    ++num_outside;
    const double distance = p.norm() - 1;
    const DistanceValue at = distance_at(field, p);
    REQUIRE(at.value <= distance + 1e-6);  // 32-bit values
    least_share = std::min(least_share, at.value / distance);
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d step = 1e-6 * Eigen::Vector3d::Unit(axis);
      const double slope =
          (distance_at(field, p + step).value - distance_at(field, p - step).value) / 2e-6;
      const double miss = std::abs(slope - at.gradient[axis]);
      worst_slope = std::max(worst_slope, miss);
    }
  }
  CHECK(num_outside > 3000);
  CHECK(least_share > 0.5);   // measured 0.70: the bound is no idle one
  CHECK(worst_slope < 1e-6);  // measured 4.4e-10
}

TEST_CASE("at_the_border_of_the_grid_the_value_drops_by_less_than_a_quarter_of_the_spacing") {
  const DistanceField field = ball_field(0.3);
  std::mt19937 rng(13);
  std::uniform_real_distribution<double> place(-1.5, 1.5);
  for (int n = 0; n < 500; ++n) {
    Eigen::Vector3d p(place(rng), place(rng), field.origin_b.z());
    const double border = distance_at(field, p + Eigen::Vector3d(0, 0, 1e-9)).value;
    const double beyond = distance_at(field, p - Eigen::Vector3d(0, 0, 1e-9)).value;
    REQUIRE(beyond < border);
    REQUIRE(border - beyond < 0.25 * field.spacing);
  }
}

TEST_CASE("a_point_that_is_no_number_gives_no_number") {
  const DistanceField field = ball_field(0.3);
  CHECK(std::isnan(distance_at(field, {NAN, 0, 0}).value));
  CHECK(std::isnan(distance_at(field, {5, NAN, 0}).value));
}

TEST_CASE("a_spring_along_the_distance_does_no_work_round_a_closed_path") {
  // Force -k value gradient, potential k value^2 / 2. The path passes many cells inside the ball.
  const DistanceField field = ball_field(0.13);
  const auto place = [](double s) {
    const double turn = 2 * std::numbers::pi * s;
    return Eigen::Vector3d(0.9 * std::cos(turn), 0.7 * std::sin(turn), 0.3 * std::sin(2 * turn));
  };
  double work = 0, work_of_unit_normals = 0, effort = 0;
  constexpr int kPieces = 200000;
  for (int n = 0; n < kPieces; ++n) {
    const Eigen::Vector3d from = place(double(n) / kPieces), to = place(double(n + 1) / kPieces);
    const DistanceValue at = distance_at(field, 0.5 * (from + to));
    const double piece = -at.value * at.gradient.dot(to - from);
    work += piece;
    work_of_unit_normals += piece / at.gradient.norm();
    effort += std::abs(piece);
  }
  CHECK(effort > 0.05);
  CHECK(std::abs(work) < 1e-5 * effort);  // measured 3.1e-6, falls with the pieces
  // Why the gradient is not normalised: that force would be no gradient.
  CHECK(std::abs(work_of_unit_normals) > 1e-4 * effort);  // measured 4.2e-4
}
