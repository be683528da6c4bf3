// SPDX-License-Identifier: MIT
// The particles that may touch something soon, in cell order: where they are and what acts on them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "dem/bodies.h"
#include "dem/lanes.h"
#include "dem/thread_pool.h"

namespace verisim::dem {

// One particle's values lie together because a contact reads those of two particles at random
// places: one stretch of memory each instead of ten.

struct RowMotion {
  Quad place;     // m, particle centre; w: radius
  Quad velocity;  // m/s, of the particle centre
  Quad spin;      // rad/s, of its body

  double radius() const { return place.w; }
};

/// Sums over the contacts of one particle; w means nothing.
struct RowLoad {
  Quad elastic;          // N
  Quad damping;          // N
  Quad friction;         // N
  Quad friction_torque;  // N m, about the particle centre; the others pass through it
};

struct ParticleRows {
  std::vector<int> particle;  // [R] index in file order
  std::vector<int> body;      // [R]
  std::vector<RowMotion> motion;
  std::vector<RowLoad> load;

  // Rows of each body, by rising particle index.
  std::vector<int> body_begin;  // [B + 1] into body_rows
  std::vector<int> body_rows;   // [R]

  int count() const { return static_cast<int>(particle.size()); }
};

/// No rows yet, and room for all particles.
ParticleRows make_rows(int num_bodies, int num_particles);

/// Row ranges of threads are cut at multiples of this, so that sums over blocks do not depend on
/// the number of threads.
constexpr int kRowBlock = 128;

/// Takes place and velocity of every row from its body.
void refresh_rows(ParticleRows& rows, const Bodies& bodies, const Particles& particles,
                  ThreadPool& pool);

}  // namespace verisim::dem
