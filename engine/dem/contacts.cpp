// SPDX-License-Identifier: MIT
// Forces of all listed particle pairs and planes on the particles.
#include "dem/contacts.h"

#include <algorithm>
#include <cmath>

namespace verisim::dem {
namespace {

/// What one contact does to particle i; particle j (or the plane) feels the opposite forces.
struct Contact {
  Eigen::Vector3d normal;    // from j to i
  double overlap;            // m
  double normal_velocity;    // m/s, negative while approaching
  Eigen::Vector3d elastic;   // N
  Eigen::Vector3d damping;   // N
  Eigen::Vector3d friction;  // N
};

/// relative_velocity: of i against j at the contact point (m/s).
Contact apply_law(const Eigen::Vector3d& normal, double overlap,
                  const Eigen::Vector3d& relative_velocity, double root_mass,
                  const ContactLaw& law) {
  Contact contact;
  contact.normal = normal;
  contact.overlap = overlap;
  contact.normal_velocity = relative_velocity.dot(normal);
  const Eigen::Vector3d tangential_velocity =
      relative_velocity - contact.normal_velocity * normal;
  contact.elastic = (law.stiffness * overlap) * normal;
  contact.damping = (-law.damping_rate * root_mass * contact.normal_velocity) * normal;
  contact.friction = (-law.tangential_rate * root_mass) * tangential_velocity;
  return contact;
}

// Two particles whose centres coincide have no normal; they are pushed apart upwards.
Eigen::Vector3d unit_or_up(const Eigen::Vector3d& v, double length) {
  return length > 0 ? Eigen::Vector3d(v * (1 / length)) : Eigen::Vector3d::UnitZ();
}

struct Arms {
  double i, j;  // m, from the particle centres to the contact point
};

Contact contact_of(const RowMotion& i, const RowMotion& j, double distance, double root_mass,
                   const ContactLaw& law, Arms& arms) {
  const Eigen::Vector3d normal = unit_or_up(i.position - j.position, distance);
  const double overlap = i.radius + j.radius - distance;
  arms = {i.radius - 0.5 * overlap, j.radius - 0.5 * overlap};
  // Contact point: i's centre - arms.i * normal = j's centre + arms.j * normal.
  const Eigen::Vector3d roll = arms.i * i.spin + arms.j * j.spin;
  const Eigen::Vector3d velocity = i.velocity - j.velocity - roll.cross(normal);
  return apply_law(normal, overlap, velocity, root_mass, law);
}

void count(ContactSums& sums, const Contact& contact, double smaller_radius, double stiffness) {
  sums.elastic_energy += 0.5 * stiffness * contact.overlap * contact.overlap;
  sums.overlap += contact.overlap;
  sums.max_overlap = std::max(sums.max_overlap, contact.overlap);
  sums.max_excess = std::max(sums.max_excess, contact.overlap - smaller_radius);
  ++sums.num_contacts;
}

/// All that one thread needs for its rows [begin, end).
struct Range {
  ParticleRows& rows;
  Neighbours& neighbours;
  const ContactLaw& law;
  int begin, end;
};

void add_plane_contacts(const Range& range, int row, const std::vector<PlaneDefinition>& planes,
                        std::vector<Transition>& transitions, ContactSums& sums) {
  const Neighbours& lists = range.neighbours;
  for (std::uint32_t k = lists.plane_begin[row]; k < lists.plane_begin[row + 1]; ++k) {
    const PlaneDefinition& plane = planes[lists.plane_pairs[k].plane];
    const RowMotion& i = range.rows.motion[row];
    const double overlap = i.radius + plane.offset - plane.normal.dot(i.position);
    const bool touches = overlap > 0;
    const bool touched = lists.plane_touching[k] != 0;
    if (!touches && !touched) continue;
    const double arm = i.radius - 0.5 * overlap;
    const Eigen::Vector3d velocity = i.velocity - arm * i.spin.cross(plane.normal);
    const Contact contact =
        apply_law(plane.normal, overlap, velocity, lists.plane_pairs[k].root_mass, range.law);
    if (touches != touched) {
      transitions.push_back({k, touches, contact.normal_velocity});
      range.neighbours.plane_touching[k] = touches;
    }
    if (!touches) continue;
    RowLoad& load = range.rows.load[row];
    load.elastic += contact.elastic;
    load.damping += contact.damping;
    load.friction += contact.friction;
    load.friction_torque -= arm * plane.normal.cross(contact.friction);
    count(sums, contact, i.radius, range.law.stiffness);
    const Eigen::Vector3d force = contact.elastic + contact.damping + contact.friction;
    sums.plane_force += force;
    sums.plane_torque += (i.position - arm * plane.normal).cross(force);
  }
}

/// Pairs of an earlier thread's i with j in this range: the same arithmetic as there, but only j's
/// half is kept. So every particle is written by one thread only.
void add_border_pairs(const Range& range, const std::vector<std::uint32_t>& border) {
  for (const std::uint32_t k : border) {
    const ParticlePair pair = range.neighbours.pairs[k];
    const RowMotion& i = range.rows.motion[pair.i];
    const RowMotion& j = range.rows.motion[pair.j];
    const double distance_squared = (i.position - j.position).squaredNorm();
    const double reach = i.radius + j.radius;
    if (distance_squared >= reach * reach) continue;
    Arms arms;
    const Contact contact =
        contact_of(i, j, std::sqrt(distance_squared), pair.root_mass, range.law, arms);
    RowLoad& load = range.rows.load[pair.j];
    load.elastic -= contact.elastic;
    load.damping -= contact.damping;
    load.friction -= contact.friction;
    load.friction_torque -= arms.j * contact.normal.cross(contact.friction);
  }
}

void note_end(const Range& range, std::uint32_t k, std::vector<Transition>& transitions) {
  const ParticlePair pair = range.neighbours.pairs[k];
  const RowMotion& i = range.rows.motion[pair.i];
  const RowMotion& j = range.rows.motion[pair.j];
  Arms arms;
  const double distance = (i.position - j.position).norm();
  const Contact contact = contact_of(i, j, distance, pair.root_mass, range.law, arms);
  transitions.push_back({k, false, contact.normal_velocity});
  range.neighbours.pair_touching[k] = 0;
}

void add_pairs_of(const Range& range, int row, std::vector<Transition>& transitions,
                  ContactSums& sums) {
  const RowMotion& i = range.rows.motion[row];
  RowLoad own = range.rows.load[row];
  const std::uint32_t end = range.neighbours.pair_begin[row + 1];
  for (std::uint32_t k = range.neighbours.pair_begin[row]; k < end; ++k) {
    const ParticlePair pair = range.neighbours.pairs[k];
    const RowMotion& j = range.rows.motion[pair.j];
    const double distance_squared = (i.position - j.position).squaredNorm();
    const double reach = i.radius + j.radius;
    if (distance_squared >= reach * reach) {
      if (range.neighbours.pair_touching[k]) note_end(range, k, transitions);
      continue;
    }
    Arms arms;
    const Contact contact =
        contact_of(i, j, std::sqrt(distance_squared), pair.root_mass, range.law, arms);
    if (!range.neighbours.pair_touching[k]) {
      transitions.push_back({k, true, contact.normal_velocity});
      range.neighbours.pair_touching[k] = 1;
    }
    count(sums, contact, std::min(i.radius, j.radius), range.law.stiffness);
    const Eigen::Vector3d turn = contact.normal.cross(contact.friction);
    own.elastic += contact.elastic;
    own.damping += contact.damping;
    own.friction += contact.friction;
    own.friction_torque -= arms.i * turn;
    if (pair.j >= static_cast<std::uint32_t>(range.end)) continue;  // another thread's
    RowLoad& other = range.rows.load[pair.j];
    other.elastic -= contact.elastic;
    other.damping -= contact.damping;
    other.friction -= contact.friction;
    other.friction_torque -= arms.j * turn;
  }
  range.rows.load[row] = own;
}

}  // namespace

ContactSums evaluate_contacts(ParticleRows& rows, Neighbours& neighbours, ContactBook& book,
                              const std::vector<PlaneDefinition>& planes, const ContactLaw& law,
                              std::vector<ContactSums>& block_sums, ThreadPool& pool) {
  const int num_rows = rows.count();
  block_sums.resize(static_cast<std::size_t>((num_rows + kRowBlock - 1) / kRowBlock));
  pool.run([&](int t) {
    const Range range{rows, neighbours, law, pool.range_begin(num_rows, kRowBlock, t),
                      pool.range_begin(num_rows, kRowBlock, t + 1)};
    book.pair_transitions[t].clear();
    book.plane_transitions[t].clear();
    const RowLoad none{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                       Eigen::Vector3d::Zero()};
    for (int row = range.begin; row < range.end; ++row) {
      ContactSums& sums = block_sums[static_cast<std::size_t>(row / kRowBlock)];
      if (row % kRowBlock == 0) sums = ContactSums{};
      rows.load[row] = none;
      add_plane_contacts(range, row, planes, book.plane_transitions[t], sums);
    }
    add_border_pairs(range, neighbours.border_pairs[t]);
    for (int row = range.begin; row < range.end; ++row) {
      ContactSums& sums = block_sums[static_cast<std::size_t>(row / kRowBlock)];
      add_pairs_of(range, row, book.pair_transitions[t], sums);
    }
  });
  ContactSums total;
  for (const ContactSums& sums : block_sums) total.add(sums);
  return total;
}

}  // namespace verisim::dem
