// SPDX-License-Identifier: MIT
// Sampling, contact events and the loop around step.
#include <doctest/doctest.h>

#include <cmath>

#include "worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

namespace {

WorldDefinition dropped_ball() {
  WorldDefinition definition = world_of({ball(0.05, 0.5, {0, 0, 0.3})}, 1e4, 1e-4);
  definition.planes.push_back({});
  definition.seed.damping_ratio = 0.2;
  return definition;
}

}  // namespace

TEST_CASE("samples_lie_on_their_times_and_do_not_change_the_run") {
  World one = make_world(dropped_ball()), other = make_world(dropped_ball());
  RunOptions options = for_seconds(0.5);
  const RunResult coarse = run(one, options);
  options.sample_interval = 0.0037;
  const RunResult fine = run(other, options);
  CHECK(coarse.log.num_times() == 31);
  CHECK(fine.log.num_times() == 136);
  CHECK(one.bodies.position[0] == other.bodies.position[0]);  // bitwise
  CHECK(coarse.steps == 5000);
  CHECK(one.time == doctest::Approx(0.5).epsilon(1e-12));
  for (std::size_t n = 0; n < 10; ++n) {  // free fall, between two steps: error below g dt^2
    const double time = coarse.log.times[n];
    CHECK(time == doctest::Approx(static_cast<double>(n) / 60));
    const double exact = 0.3 - 0.5 * 9.81 * (time * time + time * 1e-4);
    CHECK(std::abs(coarse.log.at(n, 0).position.z() - exact) < 1e-7);
  }
  CHECK((coarse.log.at(30, 0).position - one.bodies.position[0]).norm() < 1e-12);
}

TEST_CASE("a_duration_that_is_no_multiple_of_dt_is_filled_with_slightly_shorter_steps") {
  World world = make_world(dropped_ball());
  const RunResult result = run(world, for_seconds(0.00995));
  CHECK(result.steps == 100);
  CHECK(result.dt == doctest::Approx(9.95e-5));
  CHECK(world.time == doctest::Approx(0.00995).epsilon(1e-12));
  CHECK(world.parameters.dt == 1e-4);
}

TEST_CASE("a_bounce_gives_a_begin_and_an_end_with_their_speeds") {
  World world = make_world(dropped_ball());
  const RunResult result = run(world, for_seconds(0.35));
  REQUIRE(result.events.size() == 2);
  const ContactEvent& begin = result.events[0];
  const ContactEvent& end = result.events[1];
  CHECK(begin.change == ContactChange::kBegin);
  CHECK(begin.body_a == 0);
  CHECK(begin.body_b == -1);
  CHECK(begin.plane == 0);
  const double fall = std::sqrt(2 * 0.25 / 9.81), speed = 9.81 * fall;
  CHECK(begin.time == doctest::Approx(fall).epsilon(1e-3));
  CHECK(begin.speed == doctest::Approx(speed).epsilon(1e-3));
  CHECK(end.change == ContactChange::kEnd);
  // Overlap ends after half a damped period; by then e = exp(-pi z / sqrt(1 - z^2)) = 0.527.
  CHECK(end.speed / begin.speed == doctest::Approx(0.527).epsilon(0.02));
  CHECK(end.time > begin.time);
}

TEST_CASE("two_bodies_of_many_particles_give_one_begin_and_one_end") {
  BodyDefinition left = cube(0.1, 3, 1, {0, 0, 0}), right = cube(0.1, 3, 1, {0.15, 0, 0});
  left.initial.linear_velocity.x() = 1;
  WorldDefinition definition = world_of({left, right}, 1e4, 1e-4);
  definition.gravity.setZero();
  definition.seed.damping_ratio = 0.1;
  World world = make_world(definition);
  const RunResult result = run(world, for_seconds(0.3));
  REQUIRE(result.events.size() == 2);
  CHECK(result.events[0].body_a == 0);
  CHECK(result.events[0].body_b == 1);
  CHECK(result.events[0].speed == doctest::Approx(1).epsilon(1e-6));
  CHECK(result.metrics.max_contacts == 9);
}

TEST_CASE("contacts_carry_over_when_the_lists_are_rebuilt") {
  // A ball rolls over a floor of fixed particles: many rebuilds, each contact begins and ends once.
  BodyDefinition table = box({0.6, 0.1, 0.02}, 0.02, 1, {0, 0, 0});
  table.motion = Motion::kFixed;
  BodyDefinition rolling = ball(0.03, 0.2, {-0.25, 0, 0.045});
  rolling.initial.linear_velocity.x() = 0.8;
  World world = make_world(world_of({table, rolling}, 2e4, 1e-4));
  int balance = 0;
  for (int n = 0; n < 5000; ++n) {
    step(world);
    for (const ContactEvent& event : world.contacts.events) {
      balance += event.change == ContactChange::kBegin ? 1 : -1;
      CHECK(balance >= 0);
      CHECK(balance <= 1);
    }
    CHECK((balance == 1) == (world.balance.contacts.num_contacts > 0));
  }
  CHECK(world.neighbours.num_rebuilds > 10);
}
