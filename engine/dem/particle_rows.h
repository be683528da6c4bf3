// SPDX-License-Identifier: MIT
// The particles that may touch something soon, in cell order: where they are and what acts on them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "dem/bodies.h"
#include "dem/thread_pool.h"

namespace verisim::dem {

// One particle's values lie together because a contact reads those of two particles at random
// places: one stretch of memory each instead of ten.

struct RowMotion {
  Eigen::Vector3d position;  // m, particle centre
  double radius;             // m
  Eigen::Vector3d velocity;  // m/s, of the particle centre
  Eigen::Vector3d spin;      // rad/s, of its body
};

/// Sums over the contacts of one particle.
struct RowLoad {
  Eigen::Vector3d elastic;          // N
  Eigen::Vector3d damping;          // N
  Eigen::Vector3d friction;         // N
  Eigen::Vector3d friction_torque;  // N m, about the particle centre; the others pass through it
};

struct ParticleRows {
  std::vector<int> particle;  // [R] index in file order
  std::vector<int> body;      // [R]
  std::vector<RowMotion> motion;
  std::vector<RowLoad> load;

  // Rows of each body, by rising particle index.
  std::vector<int> body_begin;   // [B + 1] into body_rows
  std::vector<int> body_rows;    // [R]

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

/// Sums the loads of each body's rows into its wrenches: total, damping, friction.
/// The order of addition is that of the particles, whatever the order of rows.
void gather_loads(Bodies& bodies, const ParticleRows& rows, ThreadPool& pool);

}  // namespace verisim::dem
