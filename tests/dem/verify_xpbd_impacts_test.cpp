// SPDX-License-Identifier: MIT
// Method xpbd: impacts. Rigid ones, so the closed forms hold to rounding whatever the substeps.
#include <doctest/doctest.h>

#include <cmath>

#include "verify_xpbd_worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

TEST_CASE("xpbd_bounces_rise_to_the_square_of_the_restitution_at_any_number_of_substeps") {
  // From 1 m, e 0.8: flights are exact and end on touch-down.
  for (const int substeps : {1, 20, 80}) {
    WorldDefinition definition = floor_world({ball(0.05, 1, {0, 0, 1.05})}, 0.8, 0.5);
    const Watched watched = watch(by_xpbd(definition, substeps), 3);
    const PoseLog& log = watched.result.log;
    double worst = 0;
    int bounces = 0;
    for (const ContactEvent& event : watched.result.events) {
      if (event.change != ContactChange::kEnd || bounces == 5) continue;
      for (std::size_t t = 0; t < log.num_times(); ++t) {
        if (log.times[t] <= event.time) continue;
        const Pose& pose = log.at(t, 0);
        const double apex =
            pose.position.z() - 0.05 + 0.5 * pose.linear_velocity.squaredNorm() / kGravity;
        ++bounces;
        worst = std::max(worst, std::abs(apex / std::pow(0.8, 2 * bounces) - 1));
        break;
      }
    }
    tell("xpbd bounce: substeps, apex, residual", substeps, worst,
         watched.result.metrics.energy_residual_rel);
    CHECK(bounces == 5);
    CHECK(worst < 1e-12);                                       // measured 4e-15
    CHECK(watched.result.metrics.energy_residual_rel < 1e-12);  // measured 2e-15
    CHECK(watched.rise_rel < 1e-12);
  }
}

TEST_CASE("xpbd_bounces_end_where_the_threshold_says") {
  // Approaches below 2 g h do not rebound (Mueller et al. 2020, section 3.6): the one free choice.
  for (const int substeps : {5, 20}) {
    const double threshold = 2 * kGravity / 60 / substeps;
    for (const double share : {0.9, 1.1}) {
      BodyDefinition body = ball(0.05, 1, {0, 0, 0.05});
      body.initial.linear_velocity.z() = -share * threshold;
      const Watched watched = watch(by_xpbd(floor_world({body}, 1, 0.5), substeps), 0.1);
      const double left = watched.end(0).linear_velocity.norm();
      tell("xpbd threshold: substeps, share, speed left", substeps, share, left / threshold);
      CHECK((left > 1e-6) == (share > 1));
    }
  }
}

TEST_CASE("xpbd_faces_edges_and_corners_rebound_with_the_restitution_given") {
  double worst = 0;
  for (const double e : {0.0, 0.1, 0.35, 0.5, 0.8, 0.95, 1.0}) {
    for (int pose = 0; pose < 3; ++pose) {
      BodyDefinition body = solid_box({0.1, 0.1, 0.1}, 1, {0, 0, 0.06 * std::sqrt(pose + 1.0)});
      if (pose == 1) body.initial.orientation = turned(45, Vector3d::UnitX());
      if (pose == 2) {
        body.initial.orientation =
            Eigen::Quaterniond::FromTwoVectors(Vector3d(1, 1, 1), Vector3d::UnitZ());
      }
      body.initial.linear_velocity.z() = -2;
      WorldDefinition definition = by_xpbd(floor_world({body}, e, 0.5));
      definition.gravity.setZero();
      const Watched watched = watch(definition, 0.1);
      worst = std::max(worst, std::abs(watched.end(0).linear_velocity.z() / 2 - e));
      REQUIRE(!watched.result.events.empty());
      CHECK(watched.result.events.front().speed == doctest::Approx(2));
    }
  }
  tell("xpbd restitution: worst", worst);
  CHECK(worst < 1e-9);  // measured 1.1e-14
}

TEST_CASE("xpbd_oblique_impacts_follow_the_rigid_closed_forms") {
  // v_n 2, e 0.8, mu 0.2: v_t 4 slides throughout, v_t 1 sticks and rolls on without rebound.
  for (const double vt : {4.0, 1.0}) {
    BodyDefinition body = ball(0.05, 1, {0, 0, 0.05 + 1e-4});
    body.initial.linear_velocity = {vt, 0, -2};
    WorldDefinition definition = by_xpbd(floor_world({body}, 0.8, 0.2));
    definition.gravity.setZero();
    const Pose end = watch(definition, 0.1).end(0);
    const double slowed = std::min(0.2 * 1.8 * 2, vt / 3.5);
    const double speed = end.linear_velocity.x() / (vt - slowed) - 1;
    const double spin = end.angular_velocity.y() * 0.05 / (2.5 * slowed) - 1;
    tell("xpbd oblique: v_t, errors of v_n, v_t, spin", vt, end.linear_velocity.z() / 1.6 - 1,
         speed, spin);
    CHECK(end.linear_velocity.z() == doctest::Approx(1.6).epsilon(1e-12));
    CHECK(std::abs(speed) < 1e-12);  // measured 2e-16
    CHECK(std::abs(spin) < 1e-12);   // measured 2e-16
  }
}

TEST_CASE("xpbd_cradles_pass_the_impact_to_the_last_ball_touching_or_not") {
  for (const double gap : {0.0, 1e-3}) {
    for (const bool reversed : {false, true}) {
      std::vector<BodyDefinition> balls;
      for (int i = 0; i < 5; ++i) balls.push_back(ball(0.05, 1, {i * (0.1 + gap), 0, 0}));
      balls.front().initial.position.x() -= 0.1;
      balls.front().initial.linear_velocity.x() = 1;
      if (reversed) std::reverse(balls.begin(), balls.end());
      const Watched watched = watch(by_xpbd(free_world(balls, 1, 0.5)), 0.5);
      double worst = 0;
      for (std::size_t i = 0; i < 5; ++i) {
        const double expected = i == (reversed ? 0 : 4) ? 1 : 0;
        worst = std::max(worst, std::abs(watched.end(i).linear_velocity.x() - expected));
      }
      tell("xpbd cradle: gap, reversed, worst", gap, reversed, worst);
      CHECK(worst < 1e-12);  // measured 0
    }
  }
}

TEST_CASE("xpbd_collisions_conserve_linear_and_angular_momentum_to_rounding") {
  double worst_linear = 0, worst_angular = 0, worst_residual = 0, worst_rise = 0;
  for (int i = 0; i < 8; ++i) {
    const Watched watched = watch(by_xpbd(isolated_collision(i)), 0.4);
    CHECK(!watched.result.events.empty());
    const Balance& books = watched.world.balance;
    worst_linear = std::max(worst_linear, (books.momentum - books.momentum_start).norm() / (2 + 3));
    worst_angular =
        std::max(worst_angular, (books.angular_momentum - books.angular_momentum_start).norm() /
                                    books.angular_momentum_start.norm());
    worst_residual = std::max(worst_residual, watched.result.metrics.energy_residual_rel);
    worst_rise = std::max(worst_rise, watched.rise_rel);
  }
  tell("xpbd collisions: linear, angular, residual, rise", worst_linear, worst_angular,
       worst_residual, worst_rise);
  CHECK(worst_linear < 1e-12);  // measured 2e-16
  CHECK(worst_angular < 1e-12);
  CHECK(worst_residual < 1e-3);
  CHECK(worst_rise < 1e-6);
}
