// SPDX-License-Identifier: MIT
// All forces on all bodies at the present places and velocities.
#include "dem/forces.h"

#include "dem/contacts.h"

namespace verisim::dem {
namespace {

void update_neighbours(World& world) {
  if (!margins_used_up(world.neighbours, world.bodies, *world.pool)) return;
  carry_contacts(world.contacts, world.neighbours, world.rows);
  rebuild(world.neighbours, world.rows, world.bodies, world.particles, world.planes,
          world.parameters.dt, *world.pool);
  restore_contacts(world.contacts, world.neighbours, world.rows, world.bodies, world.particles,
                   world.planes, world.time);
}

void pull_at_drag(World& world) {
  if (!world.drag) return;
  Bodies& bodies = world.bodies;
  const Drag& drag = *world.drag;
  const int b = drag.body;
  const Eigen::Vector3d arm = bodies.orientation[b] * drag.grip_b;
  const Eigen::Vector3d velocity =
      bodies.linear_velocity[b] + bodies.angular_velocity[b].cross(arm);
  world.drag_force = drag.stiffness * (drag.target - (bodies.position[b] + arm)) -
                     drag.damping * velocity;
  world.drag_torque = arm.cross(world.drag_force);
  bodies.total.force[b] += world.drag_force;
  bodies.total.torque[b] += world.drag_torque;
  BodySums& loads = world.balance.loads;
  loads.force += world.drag_force;
  loads.torque += bodies.position[b].cross(world.drag_force) + world.drag_torque;
  loads.force_size += world.drag_force.norm();
  loads.torque_size += (bodies.position[b].cross(world.drag_force) + world.drag_torque).norm();
}

/// Kinetic energy (J) that half a step of the present load adds to a free body.
double centring_energy(const Bodies& bodies, int b, double dt) {
  const Eigen::Vector3d& force = bodies.total.force[b];
  const Eigen::Vector3d& torque = bodies.total.torque[b];
  const double all_axes = bodies.inverse_inertia_all_axes[b];
  const Eigen::Vector3d gain =
      all_axes > 0 ? Eigen::Vector3d(all_axes * torque)
                   : angular_velocity_of(bodies.inverse_inertia_b[b], bodies.orientation[b], torque);
  const double power =
      force.dot(bodies.linear_velocity[b]) + torque.dot(bodies.angular_velocity[b]);
  return 0.5 * dt * power +
         0.125 * dt * dt * (force.squaredNorm() / bodies.mass[b] + torque.dot(gain));
}

/// Adds gravity and outside loads, and sums what reaches the free bodies from outside of them.
void add_loads(World& world) {
  Bodies& bodies = world.bodies;
  Balance& balance = world.balance;
  const Eigen::Vector3d gravity = world.parameters.gravity;
  const double gravity_size = gravity.norm();
  // Leapfrog ends its step with velocities and positions of the same time.
  const double lag = world.parameters.integrator == Integrator::kSeed ? world.parameters.dt : 0;
  balance.loads = sum_over_bodies(
      balance.body_blocks, bodies.count(), *world.pool, [&](BodySums& sums, int begin, int end) {
        for (int b = begin; b < end; ++b) {
          Eigen::Vector3d& force = bodies.total.force[b];
          Eigen::Vector3d& torque = bodies.total.torque[b];
          if (bodies.motion[b] != Motion::kFree) {
            // Free bodies feel the reaction of what they do to this one.
            sums.force -= force;
            sums.torque -= bodies.position[b].cross(force) + torque;
            continue;
          }
          const Eigen::Vector3d applied = bodies.mass[b] * gravity + bodies.outside.force[b];
          sums.force_size += bodies.mass[b] * gravity_size + force.norm() +
                             bodies.outside.force[b].norm();
          sums.force += applied;
          sums.torque += bodies.position[b].cross(applied) + bodies.outside.torque[b];
          sums.torque_size += (bodies.position[b].cross(force) + torque).norm() +
                              bodies.position[b].cross(applied).norm() +
                              bodies.outside.torque[b].norm();
          force += applied;
          torque += bodies.outside.torque[b];
          if (lag > 0) sums.centring_energy += centring_energy(bodies, b, lag);
        }
      });
  balance.loads.force += balance.contacts.plane_force;
  balance.loads.torque += balance.contacts.plane_torque;
  pull_at_drag(world);
}

int first_nonfinite_load(const World& world) {
  constexpr double kLimit = 1e100;  // N, N m
  for (int b = 0; b < world.bodies.count(); ++b) {
    const double size = world.bodies.total.force[b].lpNorm<1>() +
                        world.bodies.total.torque[b].lpNorm<1>();
    if (!(size < kLimit)) return b;  // also true of NaN
  }
  return -1;
}

}  // namespace

int evaluate_forces(World& world) {
  update_neighbours(world);
  refresh_rows(world.rows, world.bodies, world.particles, *world.pool);
  world.balance.contacts = evaluate_contacts(
      world.rows, world.neighbours, world.contacts, world.planes,
      contact_law(world.parameters.seed), world.balance.contact_blocks, *world.pool);
  gather_loads(world.bodies, world.rows, *world.pool);
  add_loads(world);
  record_transitions(world.contacts, world.neighbours, world.rows, world.bodies.count(),
                     world.time);
  return first_nonfinite_load(world);
}

}  // namespace verisim::dem
