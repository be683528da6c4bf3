// SPDX-License-Identifier: MIT
// Method xpbd: what rests, slides, rolls and spins, each with the limit that one sweep per substep
// has. The depth of a stack is about (bodies above) g h^2 / 2, h the substep: what one sweep leaves
// over is what the next one starts from.
#include <doctest/doctest.h>

#include <cmath>

#include "verify_xpbd_worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

namespace {

VERISIM_OUT_OF_LINE WorldDefinition tower_of(int count, double top_mass = 1) {
  std::vector<BodyDefinition> boxes;
  for (int i = 0; i < count; ++i) boxes.push_back(solid_box({1, 1, 1}, 1, {0, 0, 0.5 + i}));
  boxes.back() = solid_box({1, 1, 1}, top_mass, boxes.back().initial.position);
  return floor_world(boxes, 0.5, 0.5);
}

double side_of(const Watched& watched) {
  double side = 0;
  const PoseLog& log = watched.result.log;
  for (std::size_t b = 0; b < log.num_bodies(); ++b) {
    side = std::max(side, watched.end(b).position.head<2>().norm());
  }
  return side;
}

double unit_of_depth(int substeps) { return 0.5 * kGravity / std::pow(60.0 * substeps, 2); }

/// Gravity turned instead of the floor: down is the slope's normal, along x it pulls.
WorldDefinition on_slope(WorldDefinition definition, double degrees) {
  definition.gravity =
      kGravity * Vector3d(std::sin(radians(degrees)), 0, -std::cos(radians(degrees)));
  return definition;
}

}  // namespace

TEST_CASE("xpbd_towers_stand_as_deep_as_one_sweep_leaves_them") {
  for (const auto& [count, substeps] : {std::pair{5, 20}, {10, 20}, {20, 20}, {10, 80}}) {
    const Watched watched = watch(by_xpbd(tower_of(count), substeps), 4);
    const Metrics& metrics = watched.result.metrics;
    const double unit = unit_of_depth(substeps);
    const double side = side_of(watched), late = late_speed(watched, 0.5);
    tell("xpbd tower: boxes, substeps, max, mean depth / unit, side, late speed, residual", count,
         substeps, metrics.max_penetration_m / unit, metrics.mean_penetration_m / unit, side, late,
         metrics.energy_residual_rel);
    CHECK(watched.result.failures.empty());
    // The mean at rest is (count - 1) / 2 units; from a start without depth it swings to 3.5 times
    // that in the lowest.
    CHECK(metrics.mean_penetration_m / unit == doctest::Approx(0.5 * count).epsilon(0.2));
    CHECK(metrics.max_penetration_m < 4 * count * unit);  // measured 3.4
    CHECK(side < 1e-5);                                   // m; measured 1e-6
    CHECK(late < 1e-3);                                   // m/s; measured 3e-5
    CHECK(metrics.energy_residual_rel < 1e-6);            // measured 2e-8
  }
}

TEST_CASE("xpbd_heavy_boxes_on_light_ones_stand_as_deep_as_the_ratio_says") {
  // Two units times the ratio at the light box's contact; 10,000 falls through (a limit).
  for (const double ratio : {10.0, 100.0, 1000.0}) {
    const Watched watched = watch(by_xpbd(tower_of(2, ratio)), 3);
    const double unit = unit_of_depth(20);
    const double depth = watched.result.metrics.max_penetration_m / (ratio * unit);
    tell("xpbd ratio: ratio, max depth / (ratio unit), late", ratio, depth,
         late_speed(watched, 0.5));
    CHECK(watched.result.failures.empty());
    CHECK(depth < 4);  // measured 1.9
  }
}

TEST_CASE("xpbd_blocks_stick_below_the_critical_angle_and_slide_by_the_closed_form_above") {
  const double critical = std::atan(0.5) * 180 / std::numbers::pi;
  for (const double yaw : {0.0, 30.0}) {
    BodyDefinition block = solid_box({0.4, 0.3, 0.2}, 1, {0, 0, 0.1});
    block.initial.orientation = turned(yaw, Vector3d::UnitZ());
    const Watched stuck =
        watch(by_xpbd(on_slope(floor_world({block}, 0, 0.5), 0.95 * critical)), 3);
    const double crept = (stuck.end(0).position - block.initial.position).norm();
    const double late = late_speed(stuck, 1);
    const double angle = radians(critical + 3);
    const Watched slid = watch(by_xpbd(on_slope(floor_world({block}, 0, 0.5), critical + 3)), 2);
    const double pull = kGravity * (std::sin(angle) - 0.5 * std::cos(angle));
    const double error = slid.end(0).position.x() / (0.5 * pull * 4) - 1;
    tell("xpbd slope: yaw, settled, late speed, slide error", yaw, crept, late, error);
    CHECK(crept < 5e-5);            // m; measured 1.1e-5
    CHECK(late < 1e-5);             // m/s; measured 2.5e-6 (method dem: 1e-7)
    CHECK(std::abs(error) < 1e-3);  // measured 3.3e-4, one frame of slope
    CHECK(slid.result.metrics.energy_residual_rel < 1e-6);
    CHECK(stuck.result.metrics.anchor_creep_m < 1e-6);
  }
}

TEST_CASE("xpbd_spheres_slide_then_roll_by_the_closed_form") {
  for (const double mu : {0.2, 0.6}) {
    BodyDefinition body = ball(0.05, 1, {0, 0, 0.05});
    body.initial.linear_velocity.x() = 1;
    const Watched watched = watch(by_xpbd(floor_world({body}, 0.5, mu)), 1.5);
    const double rolls_after = 2 / (7 * mu * kGravity);
    const double way = 5.0 / 7 * 1.5 + rolls_after / 7;
    const Pose& end = watched.end(0);
    tell("xpbd rolling: mu, speed, spin, way", mu, end.linear_velocity.x() * 1.4 - 1,
         end.angular_velocity.y() * 0.05 * 1.4 - 1, end.position.x() / way - 1);
    CHECK(end.linear_velocity.x() * 1.4 == doctest::Approx(1).epsilon(1e-3));
    CHECK(end.angular_velocity.y() * 0.05 * 1.4 == doctest::Approx(1).epsilon(1e-3));
    CHECK(end.position.x() / way == doctest::Approx(1).epsilon(1e-3));
  }
  for (const auto& [degrees, mu] : {std::pair{20.0, 0.5}, {40.0, 0.1}}) {
    const Watched watched =
        watch(by_xpbd(on_slope(floor_world({ball(0.05, 1, {0, 0, 0.05})}, 0.5, mu), degrees)), 1);
    const double g_t = kGravity * std::sin(radians(degrees)),
                 g_n = kGravity * std::cos(radians(degrees));
    const double pull = std::tan(radians(degrees)) <= 3.5 * mu ? 5.0 / 7 * g_t : g_t - mu * g_n;
    const double error = watched.end(0).position.x() / (0.5 * pull) - 1;
    tell("xpbd ball on a slope: degrees, error of way", degrees, error);
    CHECK(std::abs(error) < 1e-3);
  }
}

TEST_CASE("xpbd_free_rotation_is_of_fourth_order") {
  BodyDefinition body = rotor(Vector3d(1, 2, 3).asDiagonal(), {0.01, 5, 0.01});
  body.shape = BoxShape{{0.1, 0.1, 0.1}, nullptr};
  const Watched watched = watch(by_xpbd(free_world({body}, 0.5, 0.5)), 20);
  tell("xpbd free rotation: energy", watched.result.metrics.energy_residual_rel);
  CHECK(watched.result.metrics.energy_residual_rel < 2e-9);  // the target of method dem
}

TEST_CASE("xpbd_boxes_tip_and_tumble_to_rest_without_gain_of_energy") {
  for (int i = 0; i < 6; ++i) {
    BodyDefinition block = solid_box({0.1, 0.15, 0.4}, 2, {0, 0, 0.5});
    block.initial.orientation = turned(15 + 25 * i, {1, 2, 0.5 * i});
    block.initial.angular_velocity = {1.0 * i, 2, -1};
    const Watched watched = watch(by_xpbd(floor_world({block}, 0.4, 0.5)), 4);
    const Metrics& metrics = watched.result.metrics;
    tell("xpbd tumble: rise, residual, late speed, depth", watched.rise_rel,
         metrics.energy_residual_rel, late_speed(watched, 0.2), metrics.max_penetration_m);
    CHECK(watched.result.failures.empty());
    CHECK(watched.rise_rel < 1e-4);
    CHECK(metrics.energy_residual_rel < 1e-3);
    CHECK(late_speed(watched, 0.2) < 1e-3);
  }
}

TEST_CASE("xpbd_turned_and_mirrored_worlds_move_alike") {
  // Half a second of a box that lands and tumbles; beyond it impacts multiply rounding.
  const auto land = [](const Eigen::Matrix3d& map) {
    BodyDefinition block = solid_box({0.1, 0.15, 0.4}, 2, map * Vector3d(0.3, 0.1, 0.3));
    const Eigen::Matrix3d start = turned(40, {1, 2, 0.5}).toRotationMatrix();
    // A mirrored box is a box again: its own axes take the reflection back.
    const Eigen::Matrix3d flip = Vector3d(1, map.determinant(), 1).asDiagonal();
    block.initial.orientation = Eigen::Quaterniond(Eigen::Matrix3d(map * start * flip));
    block.initial.linear_velocity = map * Vector3d(1, -0.5, -1);
    block.initial.angular_velocity = map.determinant() * (map * Vector3d(1, 2, -1));
    return watch(by_xpbd(floor_world({block}, 0.4, 0.5)), 0.5).end(0);
  };
  const Pose plain = land(Eigen::Matrix3d::Identity());
  const Eigen::Matrix3d turn = turned(37, Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Matrix3d mirror = Vector3d(1, -1, 1).asDiagonal();
  for (const Eigen::Matrix3d& map : {turn, mirror}) {
    const Pose other = land(map);
    const double apart = (other.position - map * plain.position).norm();
    tell("xpbd symmetry: determinant, apart", map.determinant(), apart);
    CHECK(apart < 1e-6);
  }
}

TEST_CASE("xpbd_the_work_of_corrections_has_a_name_and_closes_the_books") {
  // A box that starts 1 cm deep in the floor is let out slowly: the energy that lifts it is booked.
  const Watched watched =
      watch(by_xpbd(floor_world({solid_box({0.2, 0.2, 0.2}, 1, {0, 0, 0.09})}, 0.5, 0.5)), 1);
  const Metrics& metrics = watched.result.metrics;
  const double lifted = kGravity * (watched.end(0).position.z() - 0.09);
  tell("xpbd let out: lifted, correction, residual", lifted, metrics.correction_work_j,
       metrics.energy_residual_rel);
  CHECK(has_code(watched.result, "penetration"));
  CHECK(watched.end(0).position.z() == doctest::Approx(0.1).epsilon(1e-3));
  CHECK(metrics.correction_work_j < -0.4 * lifted);
  CHECK(metrics.energy_residual_rel < 1e-6);
  CHECK(watched.world.balance.max_kinetic_energy < 0.5 * 0.6 * 0.6);  // J: it is not thrown out
}

TEST_CASE("xpbd_runs_are_the_same_for_any_number_of_threads") {
  std::vector<BodyDefinition> boxes;
  for (int i = 0; i < 12; ++i) {
    boxes.push_back(
        solid_box({0.2, 0.2, 0.2}, 1, {0.5 * (i % 4), 0.5 * (i / 4 % 2), 0.3 + 0.25 * (i / 8)}));
    boxes.back().initial.orientation = turned(17 * i, {1, 1.0 * i, 2});
  }
  WorldDefinition definition = by_xpbd(floor_world(boxes, 0.4, 0.5));
  const Watched alone = watch(definition, 1);
  definition.num_threads = 3;
  const Watched together = watch(definition, 1);
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    CHECK(alone.end(b).position == together.end(b).position);
    CHECK(alone.end(b).orientation.coeffs() == together.end(b).orientation.coeffs());
  }
}

TEST_CASE("xpbd_refuses_what_it_does_not_model") {
  WorldDefinition definition = by_xpbd(floor_world({ball(0.05, 1, {0, 0, 1})}, 0.5, 0.5), 0);
  definition.tethers.push_back({0, Vector3d::Zero(), -1, {0, 0, 2}, -1});
  definition.material_pairs.rolling_friction = {0.1};
  const std::vector<std::string> problems = problems_of(definition);
  REQUIRE(problems.size() == 3);
  CHECK(problems[0].find("substeps") != std::string::npos);
  CHECK(problems[1].find("tethers") != std::string::npos);
  CHECK(problems[2].find("rolling friction") != std::string::npos);
}
