// SPDX-License-Identifier: MIT
// Each failure code is given where it is due, and only there.
#include <doctest/doctest.h>

#include <cmath>

#include "dem/defaults.h"
#include "worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

namespace {

VERISIM_OUT_OF_LINE RunResult run_for(const WorldDefinition& definition, double duration,
                                      std::vector<int> stands = {}) {
  World world = make_world(definition);
  RunOptions options = for_seconds(duration);
  if (!stands.empty()) options.expect = {{std::move(stands)}};
  return run(world, options);
}

VERISIM_OUT_OF_LINE WorldDefinition with_floor(WorldDefinition definition) {
  definition.planes.push_back({});
  return definition;
}

}  // namespace

TEST_CASE("a_ball_that_drops_and_bounces_with_default_settings_does_not_fail") {
  WorldDefinition definition = with_floor(world_of({ball(0.05, 0.5, {0, 0, 1})}, 1, 1));
  definition.seed = default_seed_settings(definition);
  definition.dt = default_dt(definition);
  const RunResult result = run_for(definition, 1);
  CAPTURE(codes_of(result));
  CHECK_FALSE(result.failed.has_value());
  CHECK(result.metrics.max_penetration_m < 0.25 * 0.1);  // what the default stiffness allows
  CHECK(result.metrics.max_penetration_m > 0);
}

TEST_CASE("a_cube_that_drops_on_a_corner_with_default_settings_does_not_fail") {
  BodyDefinition body = cube(0.1, 5, 0.7, {0, 0, 0.6});
  body.initial.orientation =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d(1, 1, 1), Eigen::Vector3d::UnitZ());
  WorldDefinition definition = with_floor(world_of({body}, 1, 1));
  definition.seed = default_seed_settings(definition);
  definition.dt = default_dt(definition);
  for (const Integrator integrator : {Integrator::kSeed, Integrator::kRkmk4}) {
    definition.integrator = integrator;
    const RunResult result = run_for(definition, 1);
    CAPTURE(codes_of(result));
    CHECK_FALSE(result.failed.has_value());
    CHECK(result.metrics.energy_residual_rel < 5e-4);  // measured 1.1e-5 and 2.6e-5
  }
}

TEST_CASE("a_force_that_is_not_finite_stops_the_run_and_keeps_the_last_good_state") {
  WorldDefinition definition = with_floor(world_of({ball(0.05, 0.5, {0, 0, 0.06})}, 1e300, 1e-3));
  World world = make_world(definition);
  const RunResult result = run(world, for_seconds(1));
  REQUIRE(result.failed.has_value());
  CHECK(result.failed->code == "nonfinite");
  CHECK(result.failed->body == "ball");
  CHECK(result.steps < 1000);
  CHECK(world.bodies.position[0].allFinite());
  CHECK(world.bodies.position[0].z() > 0.04);
  CHECK(std::isfinite(result.metrics.energy_end_j));
  const Eigen::Vector3d kept = world.bodies.position[0];
  step(world);
  CHECK(world.bodies.position[0] == kept);
}

TEST_CASE("an_explosion_is_reported_and_stopped") {
  WorldDefinition definition = with_floor(world_of({ball(0.05, 0.5, {0, 0, 0.06})}, 1e6, 1e-2));
  definition.seed.damping_ratio = 0;
  const RunResult result = run_for(definition, 10);
  CAPTURE(codes_of(result));
  CHECK(has_code(result, "energy_gain"));
}

TEST_CASE("a_soft_floor_lets_a_ball_penetrate_and_then_pass_through") {
  const RunResult result =
      run_for(with_floor(world_of({ball(0.05, 0.5, {0, 0, 0.5})}, 20, 1e-3)), 1);
  REQUIRE(result.failures.size() >= 1);
  CHECK(result.failed->code == "penetration");
  CHECK(result.failed->body == "ball");
  CHECK(has_code(result, "pass_through"));
  CHECK(result.steps == 1000);  // the run goes on
}

TEST_CASE("bodies_that_pass_through_each_other_are_reported") {
  BodyDefinition bullet = ball(0.05, 0.5, {-0.3, 0, 0}), target = ball(0.05, 0.5, {0, 0, 0});
  target.motion = Motion::kFixed;
  SUBCASE("slowly, through a soft contact") {
    bullet.initial.linear_velocity.x() = 3;
    WorldDefinition definition = world_of({bullet, target}, 10, 1e-3);
    definition.seed.damping_ratio = 0;
    definition.gravity.setZero();
    const RunResult result = run_for(definition, 0.3);
    CHECK(has_code(result, "pass_through"));
  }
  SUBCASE("in one step, without ever touching") {
    bullet.initial.linear_velocity.x() = 400;
    const RunResult result = run_for(world_of({bullet, target}, 1e4, 1.5e-3), 0.003);
    CHECK(has_code(result, "pass_through"));
    CHECK(result.metrics.max_contacts == 0);
  }
}

TEST_CASE("a_leaning_tower_topples") {
  BodyDefinition tower = box({0.1, 0.1, 0.4}, 0.05, 2, {0, 0, 0.22});
  tower.initial.orientation = Eigen::AngleAxisd(0.35, Eigen::Vector3d::UnitY());
  const RunResult result = run_for(with_floor(world_of({tower}, 2e4, 2e-4)), 2, {0});
  CHECK(has_code(result, "toppled"));
  CHECK_FALSE(has_code(run_for(with_floor(world_of({tower}, 2e4, 2e-4)), 2), "toppled"));
}

TEST_CASE("a_block_on_an_incline_creeps_and_is_reported_as_drifted") {
  // The source's friction is viscous: it slows a block but never holds it.
  WorldDefinition definition = with_floor(world_of({cube(0.1, 4, 1, {0, 0, 0.05})}, 2e4, 2e-4));
  definition.gravity = {2, 0, -9.6};
  const RunResult result = run_for(definition, 2, {0});
  CHECK(has_code(result, "drifted"));
}

TEST_CASE("a_body_that_keeps_bouncing_jitters") {
  WorldDefinition definition = with_floor(world_of({cube(0.1, 2, 1, {0, 0, 0.06})}, 2e4, 2e-4));
  definition.seed.damping_ratio = 0;
  CHECK(has_code(run_for(definition, 2, {0}), "jitters"));
  definition.seed.damping_ratio = 1;
  CHECK_FALSE(has_code(run_for(definition, 2, {0}), "jitters"));
}

TEST_CASE("every_problem_of_a_definition_is_named_at_once") {
  WorldDefinition definition =
      world_of({ball(0.05, -1, {0, 0, 1}), ball(0.05, 1, {0, 0, 2})}, -5, 0);
  definition.bodies[0].name = "first";
  definition.bodies[1].name = "second";
  definition.bodies[1].initial.orientation = Eigen::Quaterniond(1, 1, 0, 0);
  try {
    make_world(definition);
    FAIL("accepted");
  } catch (const std::invalid_argument& error) {
    const std::string text = error.what();
    for (const char* part :
         {"dt", "stiffness", "body first: mass is -1", "body second: orientation"}) {
      CHECK(text.find(part) != std::string::npos);
    }
  }
}
