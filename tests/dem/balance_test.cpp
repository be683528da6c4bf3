// SPDX-License-Identifier: MIT
// The energy balance closes, converges, and notices a missing term.
#include <doctest/doctest.h>

#include <cmath>

#include "worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

namespace {

/// A spinning cube thrown onto the floor: impact, damping, sliding and rolling.
World thrown_cube(Integrator integrator, double dt) {
  BodyDefinition body = cube(0.1, 4, 1, {0, 0, 0.15});
  body.initial.linear_velocity = {1, 0, -1};
  body.initial.angular_velocity = {0, 6, 2};
  WorldDefinition definition = world_of({body}, 2e4, dt);
  definition.planes.push_back({});
  definition.seed.damping_ratio = 0.5;
  definition.integrator = integrator;
  return make_world(definition);
}

/// A plate that moves down on a ball and up again.
World pressed_ball(double dt) {
  BodyDefinition plate = box({0.3, 0.3, 0.05}, 0.05, 1, {0, 0, 0.2});
  plate.motion = Motion::kPrescribed;
  plate.prescribed.times = {0, 0.2, 0.4};
  plate.prescribed.poses.assign(3, plate.initial);
  plate.prescribed.poses[1].position.z() = 0.11;
  WorldDefinition definition = world_of({plate, ball(0.05, 0.5, {0.01, 0, 0.05})}, 2e4, dt);
  definition.planes.push_back({});
  return make_world(definition);
}

}  // namespace

TEST_CASE("energy_residual_is_small_and_falls_with_the_step") {
  for (const Integrator integrator : {Integrator::kSeed, Integrator::kRkmk4}) {
    const auto residual = [&](double dt) {
      World world = thrown_cube(integrator, dt);
      run_steps(world, std::lround(0.5 / dt));
      return metrics_of(world).energy_residual_rel;
    };
    const double coarse = residual(1e-4), fine = residual(2.5e-5);
    MESSAGE(to_string(integrator) << " residual " << coarse << " -> " << fine);
    CHECK(coarse < 5e-4);  // measured 9e-5 and 3e-5
    CHECK(fine < coarse / 2);
  }
}

TEST_CASE("the_energy_residual_fails_when_any_term_is_dropped") {
  World world = thrown_cube(Integrator::kSeed, 2.5e-5);
  run_steps(world, 4000);  // 0.1 s: in the first contact
  const Balance& balance = world.balance;
  const double bound = 1e-3 * balance.energy_scale();
  REQUIRE(std::abs(balance.energy_residual()) < bound);
  CHECK(std::abs(balance.energy_residual() - balance.damping_work) > 10 * bound);
  CHECK(std::abs(balance.energy_residual() - balance.friction_work) > 10 * bound);
  CHECK(std::abs(balance.energy_residual() - balance.kinetic_energy) > 10 * bound);
  CHECK(std::abs(balance.energy_residual() - balance.potential_energy) > 10 * bound);

  World pressed = pressed_ball(2e-5);
  double with_elastic = 0, without_elastic = 0;
  while (pressed.time < 0.2) {
    step(pressed);
    const Balance& now = pressed.balance;
    with_elastic = std::max(with_elastic, std::abs(now.energy_residual()));
    without_elastic =
        std::max(without_elastic, std::abs(now.energy_residual() - now.elastic_energy));
  }
  CHECK(without_elastic > 10 * with_elastic);
}

TEST_CASE("work_of_a_prescribed_body_is_booked_as_outside_work") {
  World world = pressed_ball(2e-5);
  run_steps(world, 10000);  // 0.2 s: pressed
  CHECK(world.balance.outside_work > 0.9 * world.balance.elastic_energy);
  CHECK(world.balance.elastic_energy > 0.1);
  run_steps(world, 10000);  // 0.4 s: let go
  const Metrics metrics = metrics_of(world);
  MESSAGE("residual " << metrics.energy_residual_rel << ", outside work "
                      << metrics.outside_work_j);
  CHECK(metrics.energy_residual_rel < 1e-5);  // measured 4e-9
  CHECK(metrics.momentum_residual_rel < 1e-12);
}

TEST_CASE("live_changes_and_dragging_are_booked_as_outside_work") {
  World world = thrown_cube(Integrator::kSeed, 1e-5);
  while (world.balance.elastic_energy < 0.02 && world.time < 0.2) step(world);
  REQUIRE(world.balance.elastic_energy >= 0.02);
  set_stiffness(world, 4e4);
  set_gravity(world, {1, 0, -5});
  set_damping_ratio(world, 0.2);
  set_tangential_damping_ratio(world, 0.1);
  run_steps(world, 5000);
  set_drag(world, Drag{0, {0.05, 0.05, 0.05}, {0.5, 0, 0.5}, 200, 2});
  run_steps(world, 20000);
  set_drag(world, std::nullopt);
  set_outside_wrench(world, 0, {0, 3, 0}, {0, 0, 0.01});
  run_steps(world, 10000);
  const Metrics metrics = metrics_of(world);
  MESSAGE("residual " << metrics.energy_residual_rel << ", outside work "
                      << metrics.outside_work_j);
  CHECK(std::abs(metrics.outside_work_j) > 1);
  CHECK(metrics.energy_residual_rel < 1e-4);     // measured 1.2e-5
  CHECK(metrics.momentum_residual_rel < 1e-12);  // measured 1.4e-13, 1.3e-13
  CHECK(metrics.angular_momentum_residual_rel < 1e-12);
}
