// SPDX-License-Identifier: MIT
// Which particles may touch before any body has used up its margin of motion.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "dem/bodies.h"
#include "dem/definition.h"
#include "dem/particle_rows.h"
#include "dem/sphere_grid.h"
#include "dem/thread_pool.h"

namespace verisim::dem {

/// Rows i < j of two bodies, at least one of them free.
struct ParticlePair {
  std::uint32_t i;
  std::uint32_t j : 31;
  std::uint32_t touches : 1;  // at the last evaluation
  double root_mass;           // sqrt(kg), root of the effective mass of the two particles
};

/// A row of a free body and a plane.
struct PlanePair {
  std::uint32_t row;
  std::uint32_t plane : 31;
  std::uint32_t touches : 1;
  double root_mass;  // sqrt(kg), root of the particle's mass
};

struct Neighbours {
  std::vector<ParticlePair> pairs;         // sorted by (i, j)
  std::vector<std::uint32_t> pair_begin;   // [R + 1] pairs of each row i
  std::vector<PlanePair> plane_pairs;      // sorted by (row, plane)
  std::vector<std::uint32_t> plane_begin;  // [R + 1]
  /// Per thread: copies of the pairs whose i lies in an earlier thread's range of rows and j in its
  /// own. Copies, because the earlier thread writes to its pairs meanwhile.
  std::vector<std::vector<ParticlePair>> border_pairs;

  // Where each body was at the last rebuild, and how far its particles may move from there.
  std::vector<Eigen::Vector3d> reference_position;
  std::vector<Eigen::Quaterniond> reference_orientation;
  std::vector<double> margin;  // m
  long num_rebuilds = 0;

  // Scratch of the rebuild, kept for its memory.
  SphereGrid grid;
  std::vector<Eigen::Vector3d> place;      // [N] particle centres
  std::vector<std::uint8_t> near_another;  // [N] may touch a particle of another body
  std::vector<int> row_of_particle;        // [N] -1: none
  std::vector<Eigen::AlignedBox3d> box_b;  // [B] particle centres in body axes
};

Neighbours make_neighbours(const Bodies& bodies, const Particles& particles, int num_threads);

/// Has a body moved so far since the last rebuild that the lists may miss a contact?
bool margins_used_up(const Neighbours& neighbours, const Bodies& bodies, ThreadPool& pool);

/// Makes rows and lists afresh, all contacts marked as not touching. A body's margin grows with its
/// speed: enough for some steps of `dt`. Particles with nothing near get no row.
/// Memory and time follow the number of particles, not the extent of the world.
void rebuild(Neighbours& neighbours, ParticleRows& rows, const Bodies& bodies,
             const Particles& particles, const std::vector<PlaneDefinition>& planes, double dt,
             const ThreadPool& pool);

}  // namespace verisim::dem
