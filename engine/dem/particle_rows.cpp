// SPDX-License-Identifier: MIT
// The particles that may touch something soon: their place and motion, taken from their bodies.
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
      const double radius = bodies.particle_radius[b];
      motion.spin = Quad(bodies.angular_velocity[b]);
      if (bodies.reach[b] == 0) {  // the one particle at the centre of mass
        motion.place = Quad(bodies.position[b], radius);
        motion.velocity = Quad(bodies.linear_velocity[b]);
        continue;
      }
      const Eigen::Vector3d arm = bodies.orientation[b] * particles.offset_b[rows.particle[row]];
      motion.place = Quad(bodies.position[b] + arm, radius);
      motion.velocity = Quad(bodies.linear_velocity[b] + bodies.angular_velocity[b].cross(arm));
    }
  });
}

}  // namespace verisim::dem
