// SPDX-License-Identifier: MIT
// Forces of all listed particle pairs and planes on the particles.
#include "dem/contacts.h"

#include <algorithm>

#include "dem/pair_kernel.h"

namespace verisim::dem {
namespace {

/// The law of contact_law.h with a plane as the other side. Returns whether they touch.
bool add_plane_contact(RowLoad& load, ContactSums& sums, const RowMotion& i, PlanePair& pair,
                       const PlaneDefinition& plane, const ContactLaw& law,
                       double& normal_velocity) {
  const Eigen::Vector3d position = i.place.vector(), spin = i.spin.vector();
  const double overlap = i.radius() + plane.offset - plane.normal.dot(position);
  const double arm = i.radius() - 0.5 * overlap;  // m, from the centre to the contact point
  const Eigen::Vector3d velocity = i.velocity.vector() - arm * spin.cross(plane.normal);
  normal_velocity = velocity.dot(plane.normal);
  if (overlap <= 0) return false;

  const Eigen::Vector3d elastic = (law.stiffness * overlap) * plane.normal;
  const Eigen::Vector3d damping =
      (-law.damping_rate * pair.root_mass * normal_velocity) * plane.normal;
  const Eigen::Vector3d friction =
      (-law.tangential_rate * pair.root_mass) * (velocity - normal_velocity * plane.normal);
  load.elastic.add(elastic);
  load.damping.add(damping);
  load.friction.add(friction);
  load.friction_torque.add(-arm * plane.normal.cross(friction));

  const Eigen::Vector3d force = elastic + damping + friction;
  sums.plane_force += force;
  sums.plane_torque += (position - arm * plane.normal).cross(force);
  sums.squared_overlap += overlap * overlap;
  sums.overlap += overlap;
  sums.max_overlap = std::max(sums.max_overlap, overlap);
  sums.max_excess = std::max(sums.max_excess, overlap - i.radius());
  ++sums.num_contacts;
  return true;
}

/// Adds the loads of a row's planes.
void add_planes(const PairRange& range, int row, const std::vector<PlaneDefinition>& planes,
                std::vector<Transition>& transitions, ContactSums& sums) {
  RowLoad& load = range.rows.load[row];
  Neighbours& lists = range.neighbours;
  for (std::uint32_t k = lists.plane_begin[row]; k < lists.plane_begin[row + 1]; ++k) {
    PlanePair& pair = lists.plane_pairs[k];
    double normal_velocity = 0;
    const bool touches = add_plane_contact(load, sums, range.rows.motion[row], pair,
                                           planes[pair.plane], range.law, normal_velocity);
    if (touches == static_cast<bool>(pair.touches)) continue;
    transitions.push_back({k, touches, normal_velocity});
    pair.touches = touches;
  }
}

}  // namespace

ContactSums evaluate_contacts(ParticleRows& rows, Neighbours& neighbours, ContactBook& book,
                              const std::vector<PlaneDefinition>& planes, const ContactLaw& law,
                              std::vector<ContactSums>& block_sums, ThreadPool& pool) {
  const int num_rows = rows.count();
  block_sums.resize(static_cast<std::size_t>((num_rows + kRowBlock - 1) / kRowBlock));
  pool.run([&](int t) {
    const PairRange range{rows, neighbours, law, pool.range_begin(num_rows, kRowBlock, t),
                          pool.range_begin(num_rows, kRowBlock, t + 1)};
    book.pair_transitions[t].clear();
    book.plane_transitions[t].clear();
    for (int row = range.begin; row < range.end; ++row) {
      ContactSums& sums = block_sums[static_cast<std::size_t>(row / kRowBlock)];
      if (row % kRowBlock == 0) sums = ContactSums{};
      add_planes(range, row, planes, book.plane_transitions[t], sums);
    }
    add_border_pairs(range, neighbours.border_pairs[t]);
    for (int begin = range.begin; begin < range.end; begin += kRowBlock) {
      add_pairs(range, begin, std::min(begin + kRowBlock, range.end), book.pair_transitions[t],
                block_sums[static_cast<std::size_t>(begin / kRowBlock)]);
    }
  });
  ContactSums total;
  for (const ContactSums& sums : block_sums) total.add(sums);
  total.elastic_energy = 0.5 * law.stiffness * total.squared_overlap;
  return total;
}

}  // namespace verisim::dem
