// SPDX-License-Identifier: MIT
// Two bodies in free space: what a collision must keep, and what it may not depend on.
#include <doctest/doctest.h>

#include <utility>

#include "worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

namespace {

BodyDefinition left_box() {
  BodyDefinition body = box({0.2, 0.1, 0.3}, 0.05, 3, {0, 0, 0});
  body.initial.orientation = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized());
  body.initial.linear_velocity = {2, 0.1, 0};
  body.initial.angular_velocity = {1, 5, -2};
  return body;
}

BodyDefinition right_box() {
  BodyDefinition body = box({0.1, 0.1, 0.2}, 0.025, 1, {0.35, 0.06, 0.08});
  body.initial.orientation = Eigen::AngleAxisd(-1.1, Eigen::Vector3d(2, -1, 1).normalized());
  body.initial.linear_velocity = {-1, 0, 0};
  return body;
}

World collision(std::vector<BodyDefinition> bodies, Integrator integrator) {
  WorldDefinition definition = world_of(std::move(bodies), 1e5, 2e-5);
  definition.gravity.setZero();
  definition.seed.damping_ratio = 0.3;
  definition.integrator = integrator;
  return make_world(definition);
}

}  // namespace

TEST_CASE("a_collision_keeps_linear_and_angular_momentum") {
  for (const Integrator integrator : {Integrator::kSeed, Integrator::kRkmk4}) {
    World world = collision({left_box(), right_box()}, integrator);
    run_steps(world, 10000);
    REQUIRE(world.balance.max_contacts > 0);
    const Metrics metrics = metrics_of(world);
    CHECK(metrics.momentum_residual_rel < 1e-12);          // measured 1e-15
    CHECK(metrics.angular_momentum_residual_rel < 1e-12);  // measured 7e-14
    // No outside impulse here: the sums themselves must stay.
    CHECK(world.balance.impulse.norm() < 1e-12);
    CHECK((world.balance.momentum - world.balance.momentum_start).norm() < 1e-12);
    CHECK(world.balance.friction_work > 0);
  }
}

TEST_CASE("physics_does_not_depend_on_the_order_of_bodies") {
  World one = collision({left_box(), right_box()}, Integrator::kRkmk4);
  World other = collision({right_box(), left_box()}, Integrator::kRkmk4);
  run_steps(one, 10000);
  run_steps(other, 10000);
  for (int b = 0; b < 2; ++b) {
    // Sums run in another order, so only rounding may differ; measured 0.
    CHECK((one.bodies.position[b] - other.bodies.position[1 - b]).norm() < 1e-12);
    CHECK((one.bodies.angular_velocity[b] - other.bodies.angular_velocity[1 - b]).norm() < 1e-10);
  }
}

TEST_CASE("physics_does_not_depend_on_place_and_direction") {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(1, Eigen::Vector3d(3, 1, 2).normalized()));
  const Eigen::Vector3d shift(5, -3, 2);
  std::vector<BodyDefinition> moved = {left_box(), right_box()};
  for (BodyDefinition& body : moved) {
    Pose& pose = body.initial;
    pose = {turn * pose.position + shift, turn * pose.orientation, turn * pose.linear_velocity,
            turn * pose.angular_velocity};
  }
  World one = collision({left_box(), right_box()}, Integrator::kRkmk4);
  World other = collision(moved, Integrator::kRkmk4);
  run_steps(one, 10000);
  run_steps(other, 10000);
  for (int b = 0; b < 2; ++b) {
    const Eigen::Vector3d expected = turn * one.bodies.position[b] + shift;
    CHECK((other.bodies.position[b] - expected).norm() < 1e-10);  // measured 8e-12
  }
}

TEST_CASE("an_oblique_hit_spins_a_ball_of_one_particle") {
  // Forces act at the contact point, so the tangential one has a lever.
  BodyDefinition moving = ball(0.1, 1, {0, 0, 0}), resting = ball(0.1, 1, {0.21, 0.08, 0});
  moving.initial.linear_velocity = {1, 0, 0};
  World world = collision({moving, resting}, Integrator::kSeed);
  run_steps(world, 5000);
  CHECK(world.bodies.angular_velocity[0].z() > 0.1);
  CHECK(world.bodies.angular_velocity[1].z() > 0.1);
  CHECK(metrics_of(world).angular_momentum_residual_rel < 1e-12);
}
