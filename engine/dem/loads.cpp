// SPDX-License-Identifier: MIT
// Sums forces to bodies: from their particles, gravity, and whoever pulls from outside.
#include "dem/loads.h"

#include <algorithm>

#include "dem/advance.h"

namespace verisim::dem {
namespace {

/// Sums of one body over its particles.
void gather(Bodies& bodies, const ParticleRows& rows, int b) {
  RowLoad sum{};
  Eigen::Vector3d elastic_torque = Eigen::Vector3d::Zero(), damping_torque = elastic_torque;
  Eigen::Vector3d friction_torque = elastic_torque;
  for (int k = rows.body_begin[b]; k < rows.body_begin[b + 1]; ++k) {
    const int row = rows.body_rows[k];
    const RowLoad& load = rows.load[row];
    sum.elastic += load.elastic;
    sum.damping += load.damping;
    sum.friction += load.friction;
    sum.friction_torque += load.friction_torque;
    if (bodies.reach[b] == 0) continue;
    const Eigen::Vector3d arm = rows.motion[row].position() - bodies.position[b];
    elastic_torque += arm.cross(to_vector(load.elastic));
    damping_torque += arm.cross(to_vector(load.damping));
    friction_torque += arm.cross(to_vector(load.friction));
  }
  friction_torque += to_vector(sum.friction_torque);
  bodies.total.force[b] = to_vector(sum.elastic + sum.damping + sum.friction);
  bodies.total.torque[b] = elastic_torque + damping_torque + friction_torque;
  bodies.damping.force[b] = to_vector(sum.damping);
  bodies.damping.torque[b] = damping_torque;
  bodies.friction.force[b] = to_vector(sum.friction);
  bodies.friction.torque[b] = friction_torque;
}

/// Adds a load from outside of the free bodies, and books it as such.
void apply(Bodies& bodies, int b, const Eigen::Vector3d& force, const Eigen::Vector3d& torque,
           BodySums& sums) {
  const double size = force.norm();
  bodies.total.force[b] += force;
  bodies.total.torque[b] += torque;
  sums.force += force;
  sums.torque += bodies.position[b].cross(force) + torque;
  sums.force_size += size;
  sums.torque_size += bodies.position[b].norm() * size + torque.lpNorm<1>();
}

void pull_at_drag(World& world, BodySums& sums) {
  const Bodies& bodies = world.bodies;
  const Drag& drag = *world.drag;
  const int b = drag.body;
  const Eigen::Vector3d arm = bodies.orientation[b] * drag.grip_b;
  const Eigen::Vector3d grip = bodies.position[b] + arm;
  const Eigen::Vector3d velocity =
      bodies.linear_velocity[b] + bodies.angular_velocity[b].cross(arm);
  world.drag_force = drag.stiffness * (drag.target - grip) - drag.damping * velocity;
  world.drag_torque = arm.cross(world.drag_force);
  apply(world.bodies, b, world.drag_force, world.drag_torque, sums);
}

/// Kinetic energy (J) that half a step of the present load adds to a free body.
double centring_energy(const Bodies& bodies, int b, double dt) {
  const Eigen::Vector3d& force = bodies.total.force[b];
  const Eigen::Vector3d& torque = bodies.total.torque[b];
  const double all_axes = bodies.inverse_inertia_all_axes[b];
  const double turning =
      all_axes > 0 ? all_axes * torque.squaredNorm()
                   : torque.dot(angular_velocity_of(bodies.inverse_inertia_b[b],
                                                    bodies.orientation[b], torque));
  const double power =
      force.dot(bodies.linear_velocity[b]) + torque.dot(bodies.angular_velocity[b]);
  return 0.5 * dt * power +
         0.125 * dt * dt * (force.squaredNorm() * bodies.inverse_mass[b] + turning);
}

bool is_usable(const Bodies& bodies, int b) {
  constexpr double kLimit = 1e100;  // N, N m
  const double size = bodies.total.force[b].lpNorm<1>() + bodies.total.torque[b].lpNorm<1>();
  return size < kLimit;  // not true of NaN
}

/// Loads of bodies [begin, end), and the sum of what reaches the free bodies from outside of them.
void add_loads(World& world, int begin, int end, BodySums& block) {
  Bodies& bodies = world.bodies;
  const Eigen::Vector3d gravity = world.parameters.gravity;
  const double gravity_size = gravity.norm();
  // Leapfrog ends its step with velocities and positions of the same time.
  const double lag = world.parameters.integrator == Integrator::kSeed ? world.parameters.dt : 0;
  BodySums sums;
  for (int b = begin; b < end; ++b) {
    gather(bodies, world.rows, b);
    Eigen::Vector3d& force = bodies.total.force[b];
    Eigen::Vector3d& torque = bodies.total.torque[b];
    const Eigen::Vector3d& position = bodies.position[b];
    if (bodies.motion[b] != Motion::kFree) {
      // Free bodies feel the reaction of what they do to this one.
      sums.force -= force;
      sums.torque -= position.cross(force) + torque;
    } else {
      const Eigen::Vector3d weight = bodies.mass[b] * gravity;
      const double size = force.norm() + bodies.mass[b] * gravity_size;
      sums.force_size += size;
      sums.torque_size += position.norm() * size + torque.lpNorm<1>();
      sums.force += weight;
      sums.torque += position.cross(weight);
      force += weight;
      if (world.has_outside_wrench) {
        apply(bodies, b, bodies.outside.force[b], bodies.outside.torque[b], sums);
      }
      if (world.drag && world.drag->body == b) pull_at_drag(world, sums);
      if (lag > 0) sums.centring_energy += centring_energy(bodies, b, lag);
    }
    if (!is_usable(bodies, b) && sums.unusable_body < 0) sums.unusable_body = b;
  }
  block.add(sums);
}

}  // namespace

int load_bodies(World& world, double kick_duration) {
  Balance& balance = world.balance;
  const BodySums now = sum_over_bodies(
      balance.body_blocks, world.bodies.count(), *world.pool,
      [&](BodySums& sums, int begin, int end) {
        add_loads(world, begin, end, sums);
        if (sums.unusable_body >= 0) return;
        if (kick_duration > 0) kick(world, begin, end, kick_duration, sums);
        audit(world.bodies, begin, end, world.parameters.gravity, sums);
      });
  if (now.unusable_body >= 0) return now.unusable_body;
  book_state(balance, now);
  book_impulse(balance, kick_duration);
  book_work(balance, now);
  return -1;
}

}  // namespace verisim::dem
