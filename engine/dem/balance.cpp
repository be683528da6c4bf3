// SPDX-License-Identifier: MIT
// The books of a run: energies now, work and impulses since the start.
#include "dem/balance.h"

#include <algorithm>

namespace verisim::dem {

void ContactSums::add(const ContactSums& other) {
  elastic_energy += other.elastic_energy;
  overlap += other.overlap;
  max_overlap = std::max(max_overlap, other.max_overlap);
  max_excess = std::max(max_excess, other.max_excess);
  num_contacts += other.num_contacts;
  plane_force += other.plane_force;
  plane_torque += other.plane_torque;
}

void BodySums::add(const BodySums& other) {
  kinetic_energy += other.kinetic_energy;
  potential_energy += other.potential_energy;
  damping_work += other.damping_work;
  friction_work += other.friction_work;
  outside_work += other.outside_work;
  momentum += other.momentum;
  angular_momentum += other.angular_momentum;
  force += other.force;
  torque += other.torque;
  force_size += other.force_size;
  torque_size += other.torque_size;
  centring_energy += other.centring_energy;
}

void audit(Balance& balance, const Bodies& bodies, const Eigen::Vector3d& gravity,
           ThreadPool& pool) {
  const BodySums now = sum_over_bodies(
      balance.body_blocks, bodies.count(), pool, [&](BodySums& sums, int begin, int end) {
        for (int b = begin; b < end; ++b) {
          if (bodies.motion[b] != Motion::kFree) continue;
          const Eigen::Vector3d& v = bodies.linear_velocity[b];
          const Eigen::Vector3d& spin_momentum = bodies.angular_momentum[b];
          const Eigen::Vector3d momentum = bodies.mass[b] * v;
          sums.kinetic_energy +=
              0.5 * (momentum.dot(v) + spin_momentum.dot(bodies.angular_velocity[b]));
          sums.potential_energy -= bodies.mass[b] * gravity.dot(bodies.position[b]);
          sums.momentum += momentum;
          sums.angular_momentum += bodies.position[b].cross(momentum) + spin_momentum;
        }
      });
  balance.kinetic_energy = now.kinetic_energy;
  balance.potential_energy = now.potential_energy;
  balance.elastic_energy = balance.contacts.elastic_energy;
  balance.momentum = now.momentum;
  balance.angular_momentum = now.angular_momentum;

  balance.max_kinetic_energy = std::max(balance.max_kinetic_energy, balance.kinetic_energy);
  balance.max_elastic_energy = std::max(balance.max_elastic_energy, balance.elastic_energy);
  balance.min_potential_energy = std::min(balance.min_potential_energy, balance.potential_energy);
  balance.max_potential_energy = std::max(balance.max_potential_energy, balance.potential_energy);
  balance.max_overlap = std::max(balance.max_overlap, balance.contacts.max_overlap);
  balance.max_contacts = std::max(balance.max_contacts, balance.contacts.num_contacts);
}

void open_books(Balance& balance) {
  balance.energy_start = balance.energy();
  balance.centred_energy_start = balance.centred_energy();
  balance.momentum_start = balance.momentum;
  balance.angular_momentum_start = balance.angular_momentum;
  balance.max_kinetic_energy = balance.kinetic_energy;
  balance.max_elastic_energy = balance.elastic_energy;
  balance.min_potential_energy = balance.max_potential_energy = balance.potential_energy;
}

}  // namespace verisim::dem
