// SPDX-License-Identifier: MIT
// Rolling friction of spheres against closed forms.
#include <doctest/doctest.h>

#include <cmath>

#include "verify_worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

namespace {

VERISIM_OUT_OF_LINE WorldDefinition rolling(double speed, double rolling_friction) {
  BodyDefinition sphere = solid_ball(0.05, 1000, {0, 0, 0.05});
  sphere.initial.linear_velocity = {speed, 0, 0};
  sphere.initial.angular_velocity = {0, speed / 0.05, 0};
  WorldDefinition definition = floor_world({sphere}, 0.5, 0.5);
  definition.material_pairs.rolling_friction = {rolling_friction};
  return definition;
}

}  // namespace

TEST_CASE("a_sphere_rolls_out_by_five_sevenths_of_its_rolling_friction_and_stays") {
  // m a = -F, 2/5 m a = F - mu_r m g: a = -5/7 mu_r g.
  const double speed = 1, friction = 0.1, slowing = 5.0 / 7 * friction * kGravity;
  const Watched watched = watch(rolling(speed, friction), 2);
  const PoseLog& log = watched.result.log;
  double worst = 0;
  for (std::size_t t = 6; t < log.num_times(); ++t) {
    const double exact = std::max(0.0, speed - slowing * log.times[t]);
    worst = std::max(worst, std::abs(log.at(t, 0).linear_velocity.x() - exact));
  }
  const double way = watched.end(0).position.x() / (0.5 * speed * speed / slowing);
  tell("rolling out: error of speed, of way, last speed, residual", worst, way - 1,
       watched.end(0).linear_velocity.norm(), watched.result.metrics.energy_residual_rel);
  CHECK(worst < 0.01 * speed);                          // measured 1.9e-4
  CHECK(std::abs(way - 1) < 0.01);                      // measured 5e-5
  CHECK(watched.end(0).linear_velocity.norm() < 1e-7);  // measured 3e-14
  CHECK(watched.end(0).angular_velocity.norm() < 1e-6);
  CHECK(watched.result.metrics.energy_residual_rel < 1e-3);
  CHECK(watched.rise_rel < 1e-6);
}

TEST_CASE("a_sphere_stays_on_a_slope_below_its_rolling_friction_and_rolls_above_it") {
  for (const double share : {0.9, 1.5}) {
    WorldDefinition definition = rolling(0, 0.1);
    const double angle = std::atan(share * 0.1);
    definition.gravity = kGravity * Vector3d(std::sin(angle), 0, -std::cos(angle));
    const Watched watched = watch(definition, 1);
    const double exact = 0.5 * 5.0 / 7 * kGravity * (std::sin(angle) - 0.1 * std::cos(angle));
    tell("slope: share, way, closed form", share, watched.end(0).position.x(), exact);
    if (share < 1) {
      CHECK(watched.end(0).position.x() < 1e-5);  // measured 2.9e-6
      CHECK(watched.end(0).linear_velocity.norm() < 1e-7);
    } else {
      CHECK(std::abs(watched.end(0).position.x() / exact - 1) < 0.01);  // measured 1.8e-3
    }
  }
}

TEST_CASE("without_rolling_friction_a_sphere_keeps_rolling") {
  WorldDefinition definition = rolling(1, 0);
  const Watched watched = watch(definition, 1);
  CHECK(watched.end(0).linear_velocity.x() == doctest::Approx(1).epsilon(1e-3));
}
