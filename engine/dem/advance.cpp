// SPDX-License-Identifier: MIT
// Moves bodies: kicks change momenta by forces, drifts change places by velocities.
#include "dem/advance.h"

#include "dem/prescribed.h"
#include "dem/rotation.h"

namespace verisim::dem {
namespace {

Eigen::Vector3d spin_of(const Bodies& bodies, int b, const Eigen::Vector3d& angular_momentum) {
  const double all_axes = bodies.inverse_inertia_all_axes[b];
  if (all_axes > 0) return all_axes * angular_momentum;
  return angular_velocity_of(bodies.inverse_inertia_b[b], bodies.orientation[b], angular_momentum);
}

/// Mean velocities during a kick.
struct MeanMotion {
  Eigen::Vector3d velocity;  // m/s
  Eigen::Vector3d spin;      // rad/s
};

double power(const Wrenches& wrenches, int b, const MeanMotion& mean) {
  return wrenches.force[b].dot(mean.velocity) + wrenches.torque[b].dot(mean.spin);
}

MeanMotion kick_free(Bodies& bodies, int b, double duration) {
  Eigen::Vector3d& velocity = bodies.linear_velocity[b];
  Eigen::Vector3d& spin = bodies.angular_velocity[b];
  MeanMotion mean{velocity, spin};
  velocity += (duration / bodies.mass[b]) * bodies.total.force[b];
  bodies.angular_momentum[b] += duration * bodies.total.torque[b];
  spin = spin_of(bodies, b, bodies.angular_momentum[b]);
  mean.velocity = 0.5 * (mean.velocity + velocity);
  mean.spin = 0.5 * (mean.spin + spin);
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
  if (!is_same_on_all_axes) {
    bodies.angular_velocity[b] = spin_of(bodies, b, bodies.angular_momentum[b]);
  }
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

}  // namespace

void kick(World& world, double duration) {
  Bodies& bodies = world.bodies;
  Balance& balance = world.balance;
  const int dragged = world.drag ? world.drag->body : -1;
  const BodySums done = sum_over_bodies(
      balance.body_blocks, bodies.count(), *world.pool, [&](BodySums& sums, int begin, int end) {
        for (int b = begin; b < end; ++b) {
          if (bodies.motion[b] == Motion::kFixed) continue;
          const bool is_free = bodies.motion[b] == Motion::kFree;
          const MeanMotion mean =
              is_free ? kick_free(bodies, b, duration)
                      : MeanMotion{bodies.linear_velocity[b], bodies.angular_velocity[b]};
          sums.damping_work -= duration * power(bodies.damping, b, mean);
          sums.friction_work -= duration * power(bodies.friction, b, mean);
          // Who moves a body along a path does the work that its contacts take from it.
          sums.outside_work += is_free ? duration * power(bodies.outside, b, mean)
                                       : -duration * power(bodies.total, b, mean);
          if (b == dragged) {
            sums.outside_work += duration * (world.drag_force.dot(mean.velocity) +
                                             world.drag_torque.dot(mean.spin));
          }
        }
      });
  balance.damping_work += done.damping_work;
  balance.friction_work += done.friction_work;
  balance.outside_work += done.outside_work;
  balance.impulse += duration * balance.loads.force;
  balance.angular_impulse += duration * balance.loads.torque;
  balance.impulse_size += duration * balance.loads.force_size;
  balance.angular_impulse_size += duration * balance.loads.torque_size;
}

void drift(World& world, double duration) {
  Bodies& bodies = world.bodies;
  const Integrator integrator = world.parameters.integrator;
  const double time = world.time + duration;
  world.pool->run_ranges(bodies.count(), kBodyBlock, [&](int begin, int end) {
    for (int b = begin; b < end; ++b) {
      if (bodies.motion[b] == Motion::kFree) {
        bodies.position[b] += duration * bodies.linear_velocity[b];
        turn(bodies, b, integrator, duration);
      } else if (bodies.motion[b] == Motion::kPrescribed) {
        follow_path(bodies, b, time);
      }
    }
  });
  world.time = time;
}

}  // namespace verisim::dem
