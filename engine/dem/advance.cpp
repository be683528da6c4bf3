// SPDX-License-Identifier: MIT
// Moves bodies: kicks change momenta by forces, drifts change places by velocities.
#include "dem/advance.h"

#include "dem/prescribed.h"
#include "dem/rotation.h"

namespace verisim::dem {
namespace {

/// Mean velocities during a kick.
struct MeanMotion {
  Eigen::Vector3d velocity;  // m/s
  Eigen::Vector3d spin;      // rad/s
};

double power(const Wrenches& wrenches, int b, const MeanMotion& mean) {
  return wrenches.force[b].dot(mean.velocity) + wrenches.torque[b].dot(mean.spin);
}

/// Adds the kinetic energy (J) at the mean velocities to `mean_energy`.
MeanMotion kick_free(Bodies& bodies, int b, double duration, double& mean_energy) {
  Eigen::Vector3d& velocity = bodies.linear_velocity[b];
  Eigen::Vector3d& momentum = bodies.angular_momentum[b];
  Eigen::Vector3d& spin = bodies.angular_velocity[b];
  const Eigen::Vector3d velocity_before = velocity, momentum_before = momentum, spin_before = spin;
  velocity += (duration * bodies.inverse_mass[b]) * bodies.total.force[b];
  momentum += duration * bodies.total.torque[b];
  spin = angular_velocity_of(bodies, b);
  const MeanMotion mean{0.5 * (velocity_before + velocity), 0.5 * (spin_before + spin)};
  mean_energy += 0.5 * bodies.mass[b] * mean.velocity.squaredNorm() +
                 0.25 * (momentum_before + momentum).dot(mean.spin);
  return mean;
}

void turn(Bodies& bodies, int b, Integrator integrator, double duration) {
  Eigen::Quaterniond& q = bodies.orientation[b];
  const Eigen::Vector3d& spin = bodies.angular_velocity[b];
  const bool is_same_on_all_axes = bodies.inverse_inertia_all_axes[b] > 0;
  if (integrator == Integrator::kSeed) {
    q = turn_by_euler(q, spin, duration);
  } else if (is_same_on_all_axes) {
    q = (rotation_of(duration * spin) * q).normalized();  // exact: the spin is constant
  } else {
    q = turn_by_rkmk4(q, bodies.inverse_inertia_b[b], bodies.angular_momentum[b], duration);
  }
  if (!is_same_on_all_axes) bodies.angular_velocity[b] = angular_velocity_of(bodies, b);
}

void follow_path(Bodies& bodies, int b, double time) {
  const Pose pose = pose_at(bodies.prescribed[b], time);
  bodies.position[b] = pose.position;
  bodies.orientation[b] = pose.orientation;
  bodies.linear_velocity[b] = pose.linear_velocity;
  bodies.angular_velocity[b] = pose.angular_velocity;
  bodies.angular_momentum[b] =
      pose.orientation *
      (bodies.inertia_b[b] * (pose.orientation.conjugate() * pose.angular_velocity));
}

void drift(Bodies& bodies, int begin, int end, Integrator integrator, double duration,
           double time_after) {
  for (int b = begin; b < end; ++b) {
    if (bodies.motion[b] == Motion::kFree) {
      bodies.position[b] += duration * bodies.linear_velocity[b];
      turn(bodies, b, integrator, duration);
    } else if (bodies.motion[b] == Motion::kPrescribed) {
      follow_path(bodies, b, time_after);
    }
  }
}

}  // namespace

void kick(World& world, int begin, int end, double duration, BodySums& sums) {
  Bodies& bodies = world.bodies;
  double damping_work = 0, friction_work = 0, outside_work = 0, mean_kinetic_energy = 0;
  for (int b = begin; b < end; ++b) {
    if (bodies.motion[b] == Motion::kFixed) continue;
    if (bodies.motion[b] == Motion::kPrescribed) {
      const MeanMotion motion{bodies.linear_velocity[b], bodies.angular_velocity[b]};
      damping_work -= duration * power(bodies.damping, b, motion);
      friction_work -= duration * power(bodies.friction, b, motion);
      // Who moves a body along a path does the work that its contacts take from it.
      outside_work -= duration * power(bodies.total, b, motion);
      continue;
    }
    const MeanMotion mean = kick_free(bodies, b, duration, mean_kinetic_energy);
    damping_work -= duration * power(bodies.damping, b, mean);
    friction_work -= duration * power(bodies.friction, b, mean);
    if (world.has_outside_wrench) outside_work += duration * power(bodies.outside, b, mean);
    if (world.drag && world.drag->body == b) {
      outside_work +=
          duration * (world.drag_force.dot(mean.velocity) + world.drag_torque.dot(mean.spin));
    }
  }
  sums.mean_kinetic_energy += mean_kinetic_energy;
  sums.damping_work += damping_work;
  sums.friction_work += friction_work;
  sums.outside_work += outside_work;
}

void move_bodies(World& world, double kick_duration, double drift_duration) {
  const double time_after = world.time + drift_duration;
  book_impulse(world.balance, kick_duration);
  const BodySums done = sum_over_bodies(
      world.balance.body_blocks, world.bodies.count(), *world.pool,
      [&](BodySums& sums, int begin, int end) {
        kick(world, begin, end, kick_duration, sums);
        drift(world.bodies, begin, end, world.parameters.integrator, drift_duration, time_after);
      });
  const bool is_centred = world.parameters.integrator == Integrator::kSeed;
  book_centred_energy(world.balance,
                      is_centred ? done.mean_kinetic_energy : world.balance.kinetic_energy);
  book_work(world.balance, done);
  world.time = time_after;
}

}  // namespace verisim::dem
