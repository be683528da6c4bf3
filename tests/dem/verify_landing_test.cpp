// SPDX-License-Identifier: MIT
// How a tumbling box of method dem comes down to a plane: at the right moment, in few steps.
#include <doctest/doctest.h>

#include "verify_worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

namespace {

/// A brick with three different moments of inertia, thrown over the floor.
VERISIM_OUT_OF_LINE WorldDefinition thrown_brick(double dt) {
  BodyDefinition brick = solid_box({0.1, 0.2, 0.4}, 2, {0, 0, 1});
  brick.initial.angular_velocity = {6, 9, -4};
  WorldDefinition definition = floor_world({brick}, 0.5, 0.3);
  definition.dt = dt;
  return definition;
}

double first_touch(const RunResult& result) {
  REQUIRE(!result.events.empty());
  return result.events.front().time;
}

}  // namespace

TEST_CASE("a_tumbling_brick_lands_at_the_same_moment_whatever_the_frame_and_takes_few_steps") {
  const Watched coarse = watch(thrown_brick(1.0 / 60), 0.5);
  const Watched fine = watch(thrown_brick(1e-3), 0.5);
  const double landing = first_touch(coarse.result);
  CHECK(std::abs(landing - first_touch(fine.result)) < 1e-7);  // measured 7e-10
  // A step per frame and some to come close; bounded by the speed of its edges it took 67.
  const Watched flight = watch(thrown_brick(1.0 / 60), landing - 1e-9);
  CHECK(flight.result.events.empty());
  CHECK(double(flight.result.steps) < 60 * landing + 20);  // measured 32, limit 45
}
