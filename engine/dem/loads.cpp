// SPDX-License-Identifier: MIT
// Sums forces to bodies: from their particles, gravity, and whoever pulls from outside.
#include "dem/loads.h"

#include <utility>

#include "dem/advance.h"

namespace verisim::dem {
namespace {

void set_wrench(Wrenches& wrenches, int b, const Eigen::Vector3d& force,
                const Eigen::Vector3d& torque) {
  wrenches.force[b] = force;
  wrenches.torque[b] = torque;
}

/// Sums of one body over its particles, which are left at zero for the next evaluation: here they
/// are in the cache, a pass of its own would fetch them again.
void gather(Bodies& bodies, ParticleRows& rows, int b) {
  const bool has_arms = bodies.reach[b] > 0;
  Eigen::Vector3d elastic = Eigen::Vector3d::Zero(), elastic_torque = elastic;
  Eigen::Vector3d damping = elastic, damping_torque = elastic;
  Eigen::Vector3d friction = elastic, friction_torque = elastic;
  for (int k = rows.body_begin[b]; k < rows.body_begin[b + 1]; ++k) {
    const int row = rows.body_rows[k];
    const RowLoad load = std::exchange(rows.load[row], RowLoad{});
    elastic += load.elastic.vector();
    damping += load.damping.vector();
    friction += load.friction.vector();
    friction_torque += load.friction_torque.vector();
    if (!has_arms) continue;
    const Eigen::Vector3d arm = rows.motion[row].place.vector() - bodies.position[b];
    elastic_torque += arm.cross(load.elastic.vector());
    damping_torque += arm.cross(load.damping.vector());
    friction_torque += arm.cross(load.friction.vector());
  }
  set_wrench(bodies.total, b, elastic + damping + friction,
             elastic_torque + damping_torque + friction_torque);
  set_wrench(bodies.damping, b, damping, damping_torque);
  set_wrench(bodies.friction, b, friction, friction_torque);
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
  sums.torque_size += bodies.position[b].lpNorm<1>() * size + torque.lpNorm<1>();
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
      const double size = force.norm() + bodies.mass[b] * gravity_size;
      sums.force_size += size;
      // Sums of components are as good a measure of size as roots of squares, and cheaper.
      sums.torque_size += position.lpNorm<1>() * size + torque.lpNorm<1>();
      force += bodies.mass[b] * gravity;
      if (world.has_outside_wrench) {
        apply(bodies, b, bodies.outside.force[b], bodies.outside.torque[b], sums);
      }
      if (world.drag && world.drag->body == b) pull_at_drag(world, sums);
    }
    if (!is_usable(bodies, b) && sums.unusable_body < 0) sums.unusable_body = b;
  }
  block.add(sums);
}

}  // namespace

int load_bodies(World& world, double kick_duration) {
  Balance& balance = world.balance;
  const BodySums now = sum_over_bodies(balance.body_blocks, world.bodies.count(), *world.pool,
                                       [&](BodySums& sums, int begin, int end) {
                                         add_loads(world, begin, end, sums);
                                         if (sums.unusable_body >= 0) return;
                                         if (kick_duration > 0)
                                           kick(world, begin, end, kick_duration, sums);
                                         audit(world.bodies, begin, end, sums);
                                       });
  if (now.unusable_body >= 0) return now.unusable_body;
  book_state(balance, now, world.parameters.gravity);
  book_impulse(balance, kick_duration);
  book_work(balance, now);
  return -1;
}

}  // namespace verisim::dem
