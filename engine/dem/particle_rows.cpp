// SPDX-License-Identifier: MIT
// Carries motion from bodies to their particles, and forces from particles to their bodies.
#include "dem/particle_rows.h"

namespace verisim::dem {

ParticleRows make_rows(int num_bodies, int num_particles) {
  const auto count = static_cast<std::size_t>(num_particles);
  ParticleRows rows;
  rows.particle.reserve(count);
  rows.body.reserve(count);
  rows.motion.reserve(count);
  rows.load.reserve(count);
  rows.body_rows.reserve(count);
  rows.body_begin.assign(static_cast<std::size_t>(num_bodies) + 1, 0);
  return rows;
}

void refresh_rows(ParticleRows& rows, const Bodies& bodies, const Particles& particles,
                  ThreadPool& pool) {
  pool.run_ranges(rows.count(), kRowBlock, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) {
      const int b = rows.body[row];
      RowMotion& motion = rows.motion[row];
      const Eigen::Vector3d& spin = bodies.angular_velocity[b];
      motion.position = bodies.position[b];
      motion.velocity = bodies.linear_velocity[b];
      motion.spin = spin;
      if (bodies.reach[b] == 0) continue;  // the one particle at the centre of mass
      const Eigen::Vector3d arm = bodies.orientation[b] * particles.offset_b[rows.particle[row]];
      motion.position += arm;
      motion.velocity += spin.cross(arm);
    }
  });
}

void gather_loads(Bodies& bodies, const ParticleRows& rows, ThreadPool& pool) {
  constexpr int kBlock = 64;
  pool.run_ranges(bodies.count(), kBlock, [&](int begin, int end) {
    for (int b = begin; b < end; ++b) {
      Eigen::Vector3d elastic = Eigen::Vector3d::Zero(), elastic_torque = elastic;
      Eigen::Vector3d damping = elastic, damping_torque = elastic;
      Eigen::Vector3d friction = elastic, friction_torque = elastic;
      for (int k = rows.body_begin[b]; k < rows.body_begin[b + 1]; ++k) {
        const int row = rows.body_rows[k];
        const RowLoad& load = rows.load[row];
        elastic += load.elastic;
        damping += load.damping;
        friction += load.friction;
        friction_torque += load.friction_torque;
        if (bodies.reach[b] == 0) continue;
        const Eigen::Vector3d arm = rows.motion[row].position - bodies.position[b];
        elastic_torque += arm.cross(load.elastic);
        damping_torque += arm.cross(load.damping);
        friction_torque += arm.cross(load.friction);
      }
      bodies.total.force[b] = elastic + damping + friction;
      bodies.total.torque[b] = elastic_torque + damping_torque + friction_torque;
      bodies.damping.force[b] = damping;
      bodies.damping.torque[b] = damping_torque;
      bodies.friction.force[b] = friction;
      bodies.friction.torque[b] = friction_torque;
    }
  });
}

}  // namespace verisim::dem
