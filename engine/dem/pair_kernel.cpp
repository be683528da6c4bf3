// SPDX-License-Identifier: MIT
// The contact law applied to listed pairs of particles: the innermost loop of method `seed`.
#include "dem/pair_kernel.h"

#include <algorithm>
#include <cmath>

namespace verisim::dem {
namespace {

// One contact is a chain of about 135 cycles, each operation waiting for the one before. So a batch
// of pairs goes through it in stages: within a stage the pairs do not wait for each other.
constexpr std::uint32_t kBatch = 32;

/// A batch of pairs between two stages. Pairs that do not touch go the same way with coefficients
/// of 0: whether a pair touches cannot be predicted, and a wrong guess costs more than the law.
struct Batch {
  Lanes normal[kBatch];            // from j to i
  Lanes velocity[kBatch];          // m/s, of i against j at the contact point
  double distance[kBatch];         // m, of the centres
  double overlap[kBatch];          // m, <= 0: they do not touch
  double normal_velocity[kBatch];  // m/s, negative while approaching
};

VERISIM_INLINE void find_overlaps(Batch& batch, const RowMotion* motions, const ParticlePair* pairs,
                                  std::uint32_t count) {
  for (std::uint32_t n = 0; n < count; ++n) {
    const RowMotion& i = motions[pairs[n].i];
    const RowMotion& j = motions[pairs[n].j];
    const Lanes apart = load(i.place) - load(j.place);
    batch.normal[n] = apart;
    batch.distance[n] = std::sqrt(dot(apart, apart));
    batch.overlap[n] = i.radius() + j.radius() - batch.distance[n];
  }
  for (std::uint32_t n = 0; n < count; ++n) {
    // Two particles whose centres coincide have no normal; they are pushed apart along z.
    const double distance = batch.distance[n];
    batch.normal[n] = distance > 0 ? batch.normal[n] * (1 / distance) : Lanes{0, 0, 1, 0};
  }
}

/// Distances (m) from the particle centres to the contact point, which is
/// i's centre - i * normal = j's centre + j * normal.
struct Arms {
  double i, j;
};

VERISIM_INLINE Arms arms_of(const RowMotion& i, const RowMotion& j, double overlap) {
  return {i.radius() - 0.5 * overlap, j.radius() - 0.5 * overlap};
}

VERISIM_INLINE void find_velocities(Batch& batch, const RowMotion* motions,
                                    const ParticlePair* pairs, std::uint32_t count) {
  for (std::uint32_t n = 0; n < count; ++n) {
    const RowMotion& i = motions[pairs[n].i];
    const RowMotion& j = motions[pairs[n].j];
    const Arms arms = arms_of(i, j, batch.overlap[n]);
    const Lanes roll = arms.i * load(i.spin) + arms.j * load(j.spin);
    batch.velocity[n] = load(i.velocity) - load(j.velocity) - cross(roll, batch.normal[n]);
  }
  for (std::uint32_t n = 0; n < count; ++n) {
    batch.normal_velocity[n] = dot(batch.velocity[n], batch.normal[n]);
  }
}

/// What one pair does to particle i; particle j feels the opposite forces.
struct Contact {
  Lanes elastic, damping, friction;  // N
  Lanes turn;                        // N, normal x friction: torque per metre of arm
};

/// The law of contact_law.h.
VERISIM_INLINE void apply_law(Contact& contact, const Batch& batch, std::uint32_t n,
                              double root_mass, const ContactLaw& law) {
  const Lanes normal = batch.normal[n];
  const double root_if_touching = batch.overlap[n] > 0 ? root_mass : 0;
  const double speed = batch.normal_velocity[n];
  contact.elastic = (law.stiffness * std::max(batch.overlap[n], 0.0)) * normal;
  contact.damping = (-law.damping_rate * root_if_touching * speed) * normal;
  contact.friction =
      (-law.tangential_rate * root_if_touching) * (batch.velocity[n] - speed * normal);
  contact.turn = cross(normal, contact.friction);
}

VERISIM_INLINE void add_to_i(RowLoad& of_i, const Contact& contact, double arm) {
  store(of_i.elastic, load(of_i.elastic) + contact.elastic);
  store(of_i.damping, load(of_i.damping) + contact.damping);
  store(of_i.friction, load(of_i.friction) + contact.friction);
  store(of_i.friction_torque, load(of_i.friction_torque) - arm * contact.turn);
}

VERISIM_INLINE void add_to_j(RowLoad& of_j, const Contact& contact, double arm) {
  store(of_j.elastic, load(of_j.elastic) - contact.elastic);
  store(of_j.damping, load(of_j.damping) - contact.damping);
  store(of_j.friction, load(of_j.friction) - contact.friction);
  store(of_j.friction_torque, load(of_j.friction_torque) - arm * contact.turn);
}

VERISIM_INLINE void count_contacts(const Batch& batch, const RowMotion* motions,
                                   ParticlePair* pairs, std::uint32_t first, std::uint32_t count,
                                   std::vector<Transition>& transitions, ContactSums& sums) {
  double squares = 0, overlaps = 0, max_overlap = sums.max_overlap, max_excess = sums.max_excess;
  long num_contacts = 0;
  for (std::uint32_t n = 0; n < count; ++n) {
    const bool touches = batch.overlap[n] > 0;
    if (touches != static_cast<bool>(pairs[n].touches)) {
      transitions.push_back({first + n, touches, batch.normal_velocity[n]});
      pairs[n].touches = touches;
    }
    const double overlap = std::max(batch.overlap[n], 0.0);
    const double smaller = std::min(motions[pairs[n].i].radius(), motions[pairs[n].j].radius());
    num_contacts += touches;
    squares += overlap * overlap;
    overlaps += overlap;
    max_overlap = std::max(max_overlap, overlap);
    max_excess = std::max(max_excess, overlap - smaller);
  }
  sums.squared_overlap += squares;
  sums.overlap += overlaps;
  sums.max_overlap = max_overlap;
  sums.max_excess = max_excess;
  sums.num_contacts += num_contacts;
}

VERISIM_INLINE void add_pairs_inline(const PairRange& range, int begin, int end,
                                     std::vector<Transition>& transitions, ContactSums& sums) {
  const ContactLaw law = range.law;
  const RowMotion* const motions = range.rows.motion.data();
  RowLoad* const loads = range.rows.load.data();
  const auto range_end = static_cast<std::uint32_t>(range.end);
  const std::uint32_t last = range.neighbours.pair_begin[end];
  Batch batch;
  for (std::uint32_t k = range.neighbours.pair_begin[begin]; k < last; k += kBatch) {
    ParticlePair* const pairs = range.neighbours.pairs.data() + k;
    const std::uint32_t count = std::min(kBatch, last - k);
    find_overlaps(batch, motions, pairs, count);
    find_velocities(batch, motions, pairs, count);
    count_contacts(batch, motions, pairs, k, count, transitions, sums);
    for (std::uint32_t n = 0; n < count; ++n) {
      const ParticlePair pair = pairs[n];
      const Arms arms = arms_of(motions[pair.i], motions[pair.j], batch.overlap[n]);
      Contact contact;
      apply_law(contact, batch, n, pair.root_mass, law);
      add_to_i(loads[pair.i], contact, arms.i);
      if (pair.j < range_end) add_to_j(loads[pair.j], contact, arms.j);  // else another thread's
    }
  }
}

VERISIM_INLINE void add_border_pairs_inline(const PairRange& range,
                                            const std::vector<ParticlePair>& border) {
  const RowMotion* const motions = range.rows.motion.data();
  Batch batch;
  for (const ParticlePair& pair : border) {
    find_overlaps(batch, motions, &pair, 1);
    find_velocities(batch, motions, &pair, 1);
    Contact contact;
    apply_law(contact, batch, 0, pair.root_mass, range.law);
    const Arms arms = arms_of(motions[pair.i], motions[pair.j], batch.overlap[0]);
    add_to_j(range.rows.load[pair.j], contact, arms.j);
  }
}

// The same code for processors with four lanes in one register and for those with two.

#if defined(__x86_64__)
__attribute__((target("avx2"))) void add_pairs_avx2(const PairRange& range, int begin, int end,
                                                    std::vector<Transition>& transitions,
                                                    ContactSums& sums) {
  add_pairs_inline(range, begin, end, transitions, sums);
}
__attribute__((target("avx2"))) void add_border_pairs_avx2(
    const PairRange& range, const std::vector<ParticlePair>& border) {
  add_border_pairs_inline(range, border);
}
#else
constexpr auto add_pairs_avx2 = add_pairs;
constexpr auto add_border_pairs_avx2 = add_border_pairs;
#endif

}  // namespace

void add_pairs(const PairRange& range, int begin, int end, std::vector<Transition>& transitions,
               ContactSums& sums) {
  if (kHasAvx2) return add_pairs_avx2(range, begin, end, transitions, sums);
  add_pairs_inline(range, begin, end, transitions, sums);
}

void add_border_pairs(const PairRange& range, const std::vector<ParticlePair>& border) {
  if (kHasAvx2) return add_border_pairs_avx2(range, border);
  add_border_pairs_inline(range, border);
}

}  // namespace verisim::dem
