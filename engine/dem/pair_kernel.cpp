// SPDX-License-Identifier: MIT
// The contact law applied to listed pairs of particles: the innermost loop of method `seed`.
#include "dem/pair_kernel.h"

#include <algorithm>
#include <cmath>

namespace verisim::dem {
namespace {

/// What one contact does to particle i; particle j feels the opposite forces.
struct Contact {
  Lanes elastic, damping, friction;  // N
  Lanes turn;                        // N, normal x friction: torque per metre of arm
  double overlap;                    // m
  double normal_velocity;            // m/s, negative while approaching
  double arm_i, arm_j;               // m, from the particle centres to the contact point
};

/// See contact_law.h for the law.
VERISIM_INLINE void apply_law(Contact& contact, const RowMotion& i, const RowMotion& j,
                              double distance, double root_mass, const ContactLaw& law) {
  // Two particles whose centres coincide have no normal; they are pushed apart along z.
  const Lanes normal = distance > 0 ? (i.place - j.place) * (1 / distance) : Lanes{0, 0, 1, 0};
  contact.overlap = i.place[3] + j.place[3] - distance;
  // Contact point: i's centre - arm_i * normal = j's centre + arm_j * normal.
  contact.arm_i = i.place[3] - 0.5 * contact.overlap;
  contact.arm_j = j.place[3] - 0.5 * contact.overlap;
  const Lanes roll = contact.arm_i * i.spin + contact.arm_j * j.spin;
  const Lanes velocity = i.velocity - j.velocity - cross(roll, normal);
  contact.normal_velocity = dot(velocity, normal);
  contact.elastic = (law.stiffness * contact.overlap) * normal;
  contact.damping = (-law.damping_rate * root_mass * contact.normal_velocity) * normal;
  contact.friction =
      (-law.tangential_rate * root_mass) * (velocity - contact.normal_velocity * normal);
  contact.turn = cross(normal, contact.friction);
}

/// Distance of the centres, or -1 if the particles do not touch.
VERISIM_INLINE double distance_if_touching(const RowMotion& i, const RowMotion& j) {
  const Lanes apart = i.place - j.place;
  const double squared = dot(apart, apart);
  const double reach = i.place[3] + j.place[3];
  return squared < reach * reach ? std::sqrt(squared) : -1;
}

void note_end(const PairRange& range, std::uint32_t k, std::vector<Transition>& transitions) {
  ParticlePair& pair = range.neighbours.pairs[k];
  const RowMotion& i = range.rows.motion[pair.i];
  const RowMotion& j = range.rows.motion[pair.j];
  Contact contact;
  apply_law(contact, i, j, (i.position() - j.position()).norm(), pair.root_mass, range.law);
  transitions.push_back({k, false, contact.normal_velocity});
  pair.touches = 0;
}

void note_begin(const PairRange& range, std::uint32_t k, double normal_velocity,
                std::vector<Transition>& transitions) {
  transitions.push_back({k, true, normal_velocity});
  range.neighbours.pairs[k].touches = 1;
}

VERISIM_INLINE void add_pairs_inline(const PairRange& range, int begin, int end,
                                     std::vector<Transition>& transitions, ContactSums& sums) {
  const ContactLaw law = range.law;
  const RowMotion* const motions = range.rows.motion.data();
  RowLoad* const loads = range.rows.load.data();
  const ParticlePair* const pairs = range.neighbours.pairs.data();
  const auto range_end = static_cast<std::uint32_t>(range.end);
  double squares = 0, overlaps = 0, max_overlap = sums.max_overlap, max_excess = sums.max_excess;
  long num_contacts = 0;
  std::uint32_t k = range.neighbours.pair_begin[begin];
  for (int row = begin; row < end; ++row) {
    const RowMotion& i = motions[row];
    RowLoad own = loads[row];
    const std::uint32_t row_end = range.neighbours.pair_begin[row + 1];
    for (; k < row_end; ++k) {
      const ParticlePair pair = pairs[k];
      const RowMotion& j = motions[pair.j];
      const double distance = distance_if_touching(i, j);
      if (distance < 0) {
        if (pair.touches) note_end(range, k, transitions);
        continue;
      }
      Contact contact;
      apply_law(contact, i, j, distance, pair.root_mass, law);
      if (!pair.touches) note_begin(range, k, contact.normal_velocity, transitions);
      ++num_contacts;
      squares += contact.overlap * contact.overlap;
      overlaps += contact.overlap;
      max_overlap = std::max(max_overlap, contact.overlap);
      max_excess = std::max(max_excess, contact.overlap - std::min(i.place[3], j.place[3]));
      own.elastic += contact.elastic;
      own.damping += contact.damping;
      own.friction += contact.friction;
      own.friction_torque -= contact.arm_i * contact.turn;
      if (pair.j >= range_end) continue;  // another thread's
      RowLoad& other = loads[pair.j];
      other.elastic -= contact.elastic;
      other.damping -= contact.damping;
      other.friction -= contact.friction;
      other.friction_torque -= contact.arm_j * contact.turn;
    }
    loads[row] = own;
  }
  sums.elastic_energy += 0.5 * law.stiffness * squares;
  sums.overlap += overlaps;
  sums.max_overlap = max_overlap;
  sums.max_excess = max_excess;
  sums.num_contacts += num_contacts;
}

VERISIM_INLINE void add_border_pairs_inline(const PairRange& range,
                                            const std::vector<std::uint32_t>& border) {
  for (const std::uint32_t k : border) {
    const ParticlePair pair = range.neighbours.pairs[k];
    const RowMotion& i = range.rows.motion[pair.i];
    const RowMotion& j = range.rows.motion[pair.j];
    const double distance = distance_if_touching(i, j);
    if (distance < 0) continue;
    Contact contact;
    apply_law(contact, i, j, distance, pair.root_mass, range.law);
    RowLoad& load = range.rows.load[pair.j];
    load.elastic -= contact.elastic;
    load.damping -= contact.damping;
    load.friction -= contact.friction;
    load.friction_torque -= contact.arm_j * contact.turn;
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
    const PairRange& range, const std::vector<std::uint32_t>& border) {
  add_border_pairs_inline(range, border);
}
const bool kHasAvx2 = __builtin_cpu_supports("avx2");
#else
constexpr bool kHasAvx2 = false;
constexpr auto add_pairs_avx2 = add_pairs;
constexpr auto add_border_pairs_avx2 = add_border_pairs;
#endif

}  // namespace

void add_pairs(const PairRange& range, int begin, int end, std::vector<Transition>& transitions,
               ContactSums& sums) {
  if (kHasAvx2) return add_pairs_avx2(range, begin, end, transitions, sums);
  add_pairs_inline(range, begin, end, transitions, sums);
}

void add_border_pairs(const PairRange& range, const std::vector<std::uint32_t>& border) {
  if (kHasAvx2) return add_border_pairs_avx2(range, border);
  add_border_pairs_inline(range, border);
}

}  // namespace verisim::dem
