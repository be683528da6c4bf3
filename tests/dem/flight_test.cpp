// SPDX-License-Identifier: MIT
// Free fall, and bodies that follow given poses or do not move at all.
#include <doctest/doctest.h>

#include <cmath>

#include "dem/prescribed.h"
#include "worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

TEST_CASE("free_fall_is_exact_with_rkmk4_and_half_a_step_ahead_with_seed") {
  BodyDefinition body = ball(0.1, 2, Eigen::Vector3d(1, 2, 30));
  body.initial.linear_velocity = Eigen::Vector3d(3, -1, 5);
  const double g = 9.81, dt = 1e-3, time = 1;
  const Eigen::Vector3d exact(1 + 3 * time, 2 - time, 30 + 5 * time - 0.5 * g * time * time);
  WorldDefinition definition = world_of({body}, 1000, dt);
  for (const Integrator integrator : {Integrator::kSeed, Integrator::kRkmk4}) {
    definition.integrator = integrator;
    World world = make_world(definition);
    run_steps(world, 1000);
    // Semi-implicit Euler falls by g dt^2 n (n + 1) / 2.
    const double ahead = integrator == Integrator::kSeed ? 0.5 * g * dt * time : 0;
    const Eigen::Vector3d expected = exact - ahead * Eigen::Vector3d::UnitZ();
    CHECK((world.bodies.position[0] - expected).norm() < 1e-11);  // measured 1e-13
    CHECK((world.bodies.linear_velocity[0] - Eigen::Vector3d(3, -1, 5 - g * time)).norm() < 1e-11);
  }
}

TEST_CASE("a_fixed_body_stays_and_a_prescribed_one_follows_its_path_whatever_hits_them") {
  BodyDefinition shelf = cube(0.2, 4, 1, Eigen::Vector3d(0, 0, 0));
  shelf.motion = Motion::kFixed;
  BodyDefinition lift = cube(0.2, 4, 1, Eigen::Vector3d(1, 0, 0));
  lift.motion = Motion::kPrescribed;
  Pose low = lift.initial, high = lift.initial;
  low.linear_velocity = high.linear_velocity = Eigen::Vector3d(0, 0, 0.5);
  high.position.z() = 0.5;
  lift.prescribed = {{0, 1}, {low, high}};
  WorldDefinition definition = world_of({shelf, lift, ball(0.05, 5, Eigen::Vector3d(0, 0, 0.2)),
                                         ball(0.05, 5, Eigen::Vector3d(1, 0, 0.2))},
                                        1e5, 1e-4);
  World world = make_world(definition);
  run_steps(world, 5000);
  CHECK(world.bodies.position[0] == Eigen::Vector3d(0, 0, 0));
  CHECK(world.bodies.position[1].z() == doctest::Approx(0.25).epsilon(1e-9));
  CHECK(world.bodies.linear_velocity[1].z() == doctest::Approx(0.5).epsilon(1e-9));
  CHECK(world.bodies.position[2].z() > 0.14);  // the balls are held, not dropped
  CHECK(world.bodies.position[3].z() > 0.39);
}

TEST_CASE("a_path_passes_through_its_poses_and_its_velocities_belong_to_it") {
  PrescribedMotion path;
  path.times = {0, 1, 3};
  path.poses.resize(3);
  path.poses[1].position = Eigen::Vector3d(1, 0, 0);
  path.poses[1].linear_velocity = Eigen::Vector3d(1, 2, 0);
  path.poses[1].orientation = Eigen::AngleAxisd(1, Eigen::Vector3d::UnitX());
  path.poses[2].position = Eigen::Vector3d(1, 4, 0);
  path.poses[2].orientation = Eigen::AngleAxisd(-0.4, Eigen::Vector3d::UnitX());
  for (const double time : {0.25, 0.9, 1.5, 2.9}) {
    const double h = 1e-6;
    const Pose before = pose_at(path, time - h), at = pose_at(path, time),
               after = pose_at(path, time + h);
    const Eigen::Vector3d slope = (after.position - before.position) / (2 * h);
    CHECK((slope - at.linear_velocity).norm() < 1e-8);
    const Eigen::AngleAxisd turn(after.orientation * before.orientation.conjugate());
    CHECK((turn.axis() * turn.angle() / (2 * h) - at.angular_velocity).norm() < 1e-7);
  }
  CHECK((pose_at(path, 1).position - path.poses[1].position).norm() < 1e-15);
  CHECK(pose_at(path, 5).linear_velocity.norm() == 0);
  CHECK(pose_at(path, 5).position == path.poses[2].position);
}
