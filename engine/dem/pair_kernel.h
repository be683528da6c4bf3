// SPDX-License-Identifier: MIT
// The contact law applied to listed pairs of particles: the innermost loop of method `seed`.
#pragma once

#include <cstdint>
#include <vector>

#include "dem/balance.h"
#include "dem/contact_book.h"
#include "dem/contact_law.h"
#include "dem/neighbours.h"
#include "dem/particle_rows.h"

namespace verisim::dem {

/// Rows [begin, end) of one thread, and what it needs to add up their contacts.
struct PairRange {
  ParticleRows& rows;
  Neighbours& neighbours;
  const ContactLaw& law;
  int begin, end;
};

/// Pairs of an earlier thread's i with j in this range: the same arithmetic as there, but only j's
/// half is kept. So every particle is written by one thread only.
void add_border_pairs(const PairRange& range, const std::vector<ParticlePair>& border);

/// All pairs whose i lies in rows [begin, end), a part of the range; each half is kept where its
/// particle lies in the range. Notes contacts that began or ended.
void add_pairs(const PairRange& range, int begin, int end, std::vector<Transition>& transitions,
               ContactSums& sums);

}  // namespace verisim::dem
