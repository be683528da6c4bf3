// SPDX-License-Identifier: MIT
// Keeps count of which bodies touch, and reports each begin and end.
#pragma once

#include <cstdint>
#include <vector>

#include "dem/metrics.h"
#include "dem/neighbours.h"
#include "dem/pair_table.h"

namespace verisim::dem {

/// A particle contact that began or ended at the last evaluation.
struct Transition {
  std::uint32_t index;     // into Neighbours::pairs or plane_pairs
  bool begins;             //
  double normal_velocity;  // m/s, negative while approaching
};

struct ContactBook {
  // Number of particle contacts of each touching pair of bodies; a plane p counts as body B + p.
  PairTable<int> touching;
  std::vector<ContactEvent> events;  // of the last step, begins first

  // Filled by the evaluation, one list per thread; joined they are in order of rows.
  std::vector<std::vector<Transition>> pair_transitions;
  std::vector<std::vector<Transition>> plane_transitions;

  // Particle contacts carried across a rebuild, by (lower, higher) particle or (particle, plane).
  PairTable<std::uint8_t> carried_pairs;
  PairTable<std::uint8_t> carried_planes;
};

ContactBook make_contact_book(int num_particles, int num_threads);

/// Remembers the touching particle contacts before the lists are rebuilt.
void carry_contacts(ContactBook& book, const Neighbours& neighbours, const ParticleRows& rows);

/// Marks them in the new lists. A contact that the new lists lack has ended in between.
void restore_contacts(ContactBook& book, Neighbours& neighbours, const ParticleRows& rows,
                      const Bodies& bodies, const Particles& particles,
                      const std::vector<PlaneDefinition>& planes, double time);

/// Turns transitions of particles into begin and end events of bodies.
void record_transitions(ContactBook& book, const Neighbours& neighbours, const ParticleRows& rows,
                        int num_bodies, double time);

}  // namespace verisim::dem
