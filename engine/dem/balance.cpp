// SPDX-License-Identifier: MIT
// The books of a run: energies now, work and impulses since the start.
#include "dem/balance.h"

#include <algorithm>

namespace verisim::dem {

void ContactSums::add(const ContactSums& other) {
  squared_overlap += other.squared_overlap;
  overlap += other.overlap;
  max_overlap = std::max(max_overlap, other.max_overlap);
  max_excess = std::max(max_excess, other.max_excess);
  num_contacts += other.num_contacts;
  plane_force += other.plane_force;
  plane_torque += other.plane_torque;
}

void BodySums::add(const BodySums& other) {
  kinetic_energy += other.kinetic_energy;
  mean_kinetic_energy += other.mean_kinetic_energy;
  damping_work += other.damping_work;
  friction_work += other.friction_work;
  outside_work += other.outside_work;
  mass += other.mass;
  mass_moment += other.mass_moment;
  momentum += other.momentum;
  angular_momentum += other.angular_momentum;
  force += other.force;
  torque += other.torque;
  force_size += other.force_size;
  torque_size += other.torque_size;
  if (unusable_body < 0) unusable_body = other.unusable_body;
}

void audit(const Bodies& bodies, int begin, int end, BodySums& sums) {
  double kinetic_energy = 0, mass = 0;
  Eigen::Vector3d mass_moment = Eigen::Vector3d::Zero(), total_momentum = mass_moment;
  Eigen::Vector3d total_angular = mass_moment;
  for (int b = begin; b < end; ++b) {
    if (bodies.motion[b] != Motion::kFree) continue;
    const Eigen::Vector3d& v = bodies.linear_velocity[b];
    const Eigen::Vector3d& angular_momentum = bodies.angular_momentum[b];
    const Eigen::Vector3d momentum = bodies.mass[b] * v;
    kinetic_energy += 0.5 * (momentum.dot(v) + angular_momentum.dot(bodies.angular_velocity[b]));
    mass += bodies.mass[b];
    mass_moment += bodies.mass[b] * bodies.position[b];
    total_momentum += momentum;
    total_angular += bodies.position[b].cross(momentum) + angular_momentum;
  }
  sums.kinetic_energy += kinetic_energy;
  sums.mass += mass;
  sums.mass_moment += mass_moment;
  sums.momentum += total_momentum;
  sums.angular_momentum += total_angular;
}

void book_state(Balance& balance, const BodySums& now, const Eigen::Vector3d& gravity) {
  balance.kinetic_energy = now.kinetic_energy;
  balance.potential_energy = -gravity.dot(now.mass_moment);
  balance.elastic_energy = balance.contacts.elastic_energy;
  balance.momentum = now.momentum;
  balance.angular_momentum = now.angular_momentum;
  balance.loads = now;
  balance.loads.force += now.mass * gravity + balance.contacts.plane_force;
  balance.loads.torque += now.mass_moment.cross(gravity) + balance.contacts.plane_torque;

  balance.max_kinetic_energy = std::max(balance.max_kinetic_energy, balance.kinetic_energy);
  balance.max_elastic_energy = std::max(balance.max_elastic_energy, balance.elastic_energy);
  balance.min_potential_energy = std::min(balance.min_potential_energy, balance.potential_energy);
  balance.max_potential_energy = std::max(balance.max_potential_energy, balance.potential_energy);
}

void book_centred_energy(Balance& balance, double kinetic_energy) {
  balance.centred_energy = kinetic_energy + balance.potential_energy + balance.elastic_energy;
  balance.outside_work_before = balance.outside_work;
  if (balance.has_centred_start) return;
  balance.has_centred_start = true;
  balance.centred_energy_start = balance.centred_energy - balance.outside_work;
}

void book_work(Balance& balance, const BodySums& done) {
  balance.damping_work += done.damping_work;
  balance.friction_work += done.friction_work;
  balance.outside_work += done.outside_work;
}

void book_impulse(Balance& balance, double duration) {
  balance.impulse += duration * balance.loads.force;
  balance.angular_impulse += duration * balance.loads.torque;
  balance.impulse_size += duration * balance.loads.force_size;
  balance.angular_impulse_size += duration * balance.loads.torque_size;
}

void count_step(Balance& balance) {
  balance.overlap_total += balance.contacts.overlap;
  balance.squared_overlap_total += balance.contacts.squared_overlap;
  balance.contacts_total += static_cast<double>(balance.contacts.num_contacts);
  balance.max_overlap = std::max(balance.max_overlap, balance.contacts.max_overlap);
  balance.max_contacts = std::max(balance.max_contacts, balance.contacts.num_contacts);
}

void open_books(Balance& balance) {
  balance.energy_start = balance.energy();
  balance.momentum_start = balance.momentum;
  balance.angular_momentum_start = balance.angular_momentum;
  balance.max_kinetic_energy = balance.kinetic_energy;
  balance.max_elastic_energy = balance.elastic_energy;
  balance.max_overlap = balance.contacts.max_overlap;
  balance.max_contacts = balance.contacts.num_contacts;
  balance.min_potential_energy = balance.max_potential_energy = balance.potential_energy;
}

}  // namespace verisim::dem
