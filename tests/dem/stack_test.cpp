// SPDX-License-Identifier: MIT
// Where the method holds a stack and where it fails: the stability map of the source's own scene.
#include <doctest/doctest.h>

#include "dem/defaults.h"
#include "worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

namespace {

/// Three cubes of 4 x 4 x 4 particles, each turned by `yaw` against the one below.
/// k_hat = n k d / W: contacts of the lowest face, stiffness, particle diameter, weight of all.
WorldDefinition stack(double k_hat, double dt, double yaw) {
  const double edge = 0.2, mass = 1, weight = 3 * mass * 9.81;
  std::vector<BodyDefinition> cubes;
  for (int n = 0; n < 3; ++n) {
    cubes.push_back(cube(edge, 4, mass, {0, 0, edge * (n + 0.5)}));
    cubes.back().initial.orientation = Eigen::AngleAxisd(yaw * n, Eigen::Vector3d::UnitZ());
  }
  WorldDefinition definition = world_of(std::move(cubes), k_hat * weight / (16 * edge / 4), dt);
  definition.planes.push_back({});
  return definition;
}

RunResult run_stack(const WorldDefinition& definition) {
  World world = make_world(definition);
  RunOptions options = for_seconds(3);
  options.expect = {{{0, 1, 2}}};
  return run(world, options);
}

}  // namespace

TEST_CASE("a_stack_of_three_holds_at_k_hat_10") {
  for (const double yaw : {0.0, 0.2}) {
    const RunResult result = run_stack(stack(10, 1e-3, yaw));
    CAPTURE(codes_of(result));
    CHECK_FALSE(result.failed.has_value());
  }
}

TEST_CASE("a_stack_of_three_sinks_at_k_hat_0_3") {
  const RunResult result = run_stack(stack(0.3, 1e-3, 0.2));
  CAPTURE(codes_of(result));
  REQUIRE(result.failed.has_value());
  CHECK(result.failed->code == "penetration");  // crushed: the load exceeds n k d
  CHECK(has_code(result, "sank"));
  CHECK_FALSE(has_code(result, "energy_gain"));
}

TEST_CASE("a_stiff_stack_blows_up_when_the_step_is_too_long") {
  const RunResult result = run_stack(stack(1000, 1.0 / 240, 0));
  CAPTURE(codes_of(result));
  CHECK(has_code(result, "energy_gain"));
  CHECK_FALSE(run_stack(stack(1000, 1.0 / 8000, 0)).failed.has_value());
}

TEST_CASE("default_stiffness_and_step_hold_the_stack") {
  WorldDefinition definition = stack(1, 1, 0.2);
  definition.seed = default_seed_settings(definition);
  definition.dt = default_dt(definition);
  MESSAGE("default stiffness " << definition.seed.stiffness << " N/m, dt " << definition.dt
                               << " s");
  const RunResult result = run_stack(definition);
  CAPTURE(codes_of(result));
  CHECK_FALSE(result.failed.has_value());
}
