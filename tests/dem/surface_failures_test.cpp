// SPDX-License-Identifier: MIT
// Method dem: each failure code is given where it is due, with names, and only there.
#include <doctest/doctest.h>

#include <cmath>

#include "dem/surface_contacts.h"
#include "worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

namespace {

VERISIM_OUT_OF_LINE RunResult run_for(const WorldDefinition& definition, double duration,
                                      std::vector<int> stands = {}) {
  World world = make_world(definition);
  RunOptions options = for_seconds(duration);
  options.keep_before_failure = 0.5;
  if (!stands.empty()) options.expect = {{std::move(stands)}};
  return run(world, options);
}

VERISIM_OUT_OF_LINE WorldDefinition with_floor(WorldDefinition definition) {
  definition.planes.push_back({});
  return definition;
}

/// A ball of 0.1 m and 0.5 kg that falls 0.3 m onto springs of one stiffness.
VERISIM_OUT_OF_LINE WorldDefinition soft_landing(double stiffness) {
  WorldDefinition definition = with_floor(dem_world_of({ball(0.05, 0.5, {0, 0, 0.35})}, 0.9, 0.5));
  definition.dem.stiffness = stiffness;
  return definition;
}

VERISIM_OUT_OF_LINE BodyDefinition named(BodyDefinition body, const std::string& name) {
  body.name = name;
  return body;
}

}  // namespace

TEST_CASE("dem_drops_and_stacks_with_default_settings_do_not_fail") {
  BodyDefinition tilted = named(cube(0.1, 1, 1, {1, 0, 0.3}), "tilted");
  tilted.initial.orientation =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d(1, 1, 1), Eigen::Vector3d::UnitZ());
  const RunResult result =
      run_for(with_floor(dem_world_of({named(cube(0.1, 1, 1, {0, 0, 0.05}), "low"),
                                       named(cube(0.1, 1, 1, {0, 0, 0.15}), "high"), tilted,
                                       ball(0.05, 0.5, {-1, 0, 0.4})},
                                      0.5, 0.5)),
              1, {0, 1});
  CAPTURE(codes_of(result));
  CHECK_FALSE(result.failed.has_value());
  CHECK(result.hardest.stiffness > 0);
  CHECK(result.last.log.times.empty());
}

TEST_CASE("dem_names_who_is_more_than_a_twentieth_deep_in_what") {
  const RunResult result = run_for(soft_landing(2000), 1);  // 38 mm by energy
  REQUIRE(result.failed.has_value());
  CHECK(result.failed->code == "penetration");
  CHECK(result.failed->body == "ball");
  CHECK(result.failed->message.find("ball and ground overlap by") != std::string::npos);
  CHECK(result.failures.size() == 1);
  CHECK(result.log.num_times() == 61);                            // the run goes on
  CHECK_FALSE(run_for(soft_landing(2e6), 1).failed.has_value());  // 1.2 mm
}

TEST_CASE("dem_sees_an_impact_that_is_too_deep_between_two_frames") {
  // 7 mm deep, 9 ms long; frames are 17 ms apart, some of these drops show it to none of them.
  for (int i = 0; i < 8; ++i) {
    WorldDefinition definition = soft_landing(6e4);
    definition.bodies[0].initial.position.z() += 0.01 * i;
    const RunResult result = run_for(definition, 0.4);
    REQUIRE(result.failed.has_value());
    CHECK(result.failed->code == "penetration");
    CHECK(result.failed->body == "ball");
  }
}

TEST_CASE("dem_reports_a_ball_that_sinks_through_the_floor") {
  const RunResult result = run_for(soft_landing(100), 1);
  CHECK(has_code(result, "penetration"));
  CHECK(has_code(result, "pass_through"));
}

TEST_CASE("dem_reports_a_centre_inside_another_body") {
  BodyDefinition bullet = named(ball(0.05, 0.5, {-0.3, 0, 0}), "bullet");
  BodyDefinition target = named(cube(0.1, 1, 1, {0, 0, 0}), "target");
  target.motion = Motion::kFixed;
  bullet.initial.linear_velocity.x() = 3;
  WorldDefinition definition = dem_world_of({bullet, target}, 0.9, 0);
  definition.gravity.setZero();
  definition.dem.stiffness = 100;
  const RunResult result = run_for(definition, 0.3);
  REQUIRE(has_code(result, "pass_through"));
  CHECK(result.failures.back().body == "bullet");
  CHECK(result.failures.back().message == "the centre of bullet is inside of target");
}

TEST_CASE("dem_stops_a_bullet_that_crosses_its_target_in_less_than_a_frame") {
  BodyDefinition bullet = ball(0.05, 0.5, {-3.1, 0, 0}), target = ball(0.05, 0.5, {0, 0, 0});
  target.motion = Motion::kFixed;
  bullet.initial.linear_velocity.x() = 400;  // 67 diameters in a frame
  const RunResult result = run_for(dem_world_of({bullet, target}, 0.9, 0), 0.05);
  CAPTURE(codes_of(result));
  CHECK_FALSE(result.failed.has_value());
  REQUIRE(result.events.size() == 2);
  CHECK(result.events[1].speed / result.events[0].speed == doctest::Approx(0.9).epsilon(0.01));
}

TEST_CASE("a_start_with_bodies_in_each_other_is_a_penetration_at_time_0") {
  const auto stack_of = [](double overlap) {
    return with_floor(dem_world_of({named(cube(0.1, 1, 1, {0, 0, 0.05}), "low"),
                                    named(cube(0.1, 1, 1, {0, 0, 0.15 - overlap}), "high")},
                                   0.3, 0.5));
  };
  const RunResult deep = run_for(stack_of(0.01), 0.1);
  REQUIRE(deep.failed.has_value());
  CHECK(deep.failed->code == "penetration");
  CHECK(deep.failed->time == 0);
  CHECK(deep.failed->message.find("low and high overlap by 0.01 m from the start") == 0);
  CHECK(deep.log.num_times() == 7);
  REQUIRE(deep.last.contacts.size() >= 4);
  CHECK(deep.last.contacts[0].depth == doctest::Approx(0.01));
  CHECK_FALSE(run_for(stack_of(0), 0.1).failed.has_value());
  // Half of what is allowed.
  CHECK_FALSE(has_code(run_for(stack_of(0.5e-4), 0.1), "penetration"));
}

TEST_CASE("dem_reports_bodies_that_ought_to_stand_and_do_not") {
  BodyDefinition tower = box({0.1, 0.1, 0.4}, 0.1, 2, {0, 0, 0.22});
  tower.initial.orientation = Eigen::AngleAxisd(0.35, Eigen::Vector3d::UnitY());
  CHECK(has_code(run_for(with_floor(dem_world_of({tower}, 0.1, 0.8)), 2, {0}), "toppled"));
  WorldDefinition slope = with_floor(dem_world_of({cube(0.1, 1, 1, {0, 0, 0.05})}, 0.1, 0.1));
  slope.gravity = {2, 0, -9.6};  // 0.208 of the weight, more than the friction of 0.1
  CHECK(has_code(run_for(slope, 2, {0}), "drifted"));
  slope.material_pairs.friction = {0.5};
  const RunResult holds = run_for(slope, 2, {0});
  CAPTURE(codes_of(holds));
  CHECK_FALSE(holds.failed.has_value());
  const WorldDefinition bouncing = with_floor(dem_world_of({ball(0.05, 1, {0, 0, 0.1})}, 1, 0.5));
  CHECK(has_code(run_for(bouncing, 2, {0}), "jitters"));
}

TEST_CASE("the_moments_before_a_failure_hold_its_contacts") {
  const RunResult result = run_for(soft_landing(2000), 1);
  REQUIRE(result.failed.has_value());
  const PoseLog& log = result.last.log;
  REQUIRE(log.num_times() > 5);
  CHECK(log.times.back() == doctest::Approx(result.failed->time));
  CHECK(log.times.front() >= result.failed->time - 0.5 - 1e-9);
  REQUIRE_FALSE(result.last.contacts.empty());
  const ContactRecord& contact = result.last.contacts.back();
  CHECK(contact.time == log.times.back());
  CHECK(contact.a == 0);
  CHECK(contact.b == 1);  // the floor
  CHECK(contact.normal == Eigen::Vector3d(0, 0, 1));
  CHECK(contact.depth > 0.05 * 0.1);
  CHECK(contact.load > 0.9 * 2000 * contact.depth * 0.5);
  CHECK(std::abs(log.poses.back().position.z() - (0.05 - contact.depth)) < 1e-12);
}

TEST_CASE("the_moments_before_a_failure_of_seed_hold_its_contacts") {
  WorldDefinition definition = with_floor(world_of({ball(0.05, 0.5, {0, 0, 0.5})}, 20, 1e-4));
  const RunResult result = run_for(definition, 1);
  REQUIRE(result.failed.has_value());
  const PoseLog& log = result.last.log;
  CHECK(log.times.back() <= result.failed->time);
  CHECK(log.times.back() > result.failed->time - 1.1e-3);  // kept once a millisecond
  CHECK(log.num_times() > 300);                            // fell for 0.3 s
  CHECK(log.num_times() <= 501);
  REQUIRE_FALSE(result.last.contacts.empty());
  const ContactRecord& contact = result.last.contacts.back();
  CHECK(contact.b == 1);
  CHECK(contact.depth == doctest::Approx(0.05 - log.poses.back().position.z()).epsilon(1e-9));
  CHECK(contact.load == doctest::Approx(20 * contact.depth));
}

TEST_CASE("what_set_the_stiffest_spring_is_told") {
  const RunResult resting =
      run_for(with_floor(dem_world_of({cube(0.1, 1, 1, {0, 0, 0.05})}, 0.5, 0.5)), 0.5);
  CHECK(resting.hardest.bound == StiffnessBound::kLoad);
  const RunResult falling =
      run_for(with_floor(dem_world_of({ball(0.05, 1, {0, 0, 1})}, 0.9, 0.5)), 0.6);
  CHECK(falling.hardest.bound == StiffnessBound::kImpact);
  // m (v / d)^2, with v = 4.32 m/s and d the twentieth of the 0.1 mm allowed
  const double speed = std::sqrt(2 * 9.81 * 0.95);
  CHECK(falling.hardest.stiffness == doctest::Approx(std::pow(speed / 5e-6, 2)).epsilon(0.01));
  CHECK(falling.hardest.predicted_penetration == doctest::Approx(5e-6).epsilon(0.01));
  CHECK(falling.metrics.max_penetration_m < 1.01 * falling.hardest.predicted_penetration);
  CHECK(run_for(soft_landing(2e6), 0.5).hardest.bound == StiffnessBound::kNamed);
}
