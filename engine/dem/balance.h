// SPDX-License-Identifier: MIT
// The books of a run: energies now, work and impulses since the start.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "dem/bodies.h"
#include "dem/definition.h"
#include "dem/metrics.h"
#include "dem/thread_pool.h"

namespace verisim::dem {

/// Sums over the contacts of one evaluation.
struct ContactSums {
  double squared_overlap = 0;  // m^2
  double elastic_energy = 0;   // J, set for the sum over all blocks
  double overlap = 0;          // m
  double max_overlap = 0;      // m
  double max_excess = -1;      // m, greatest overlap beyond half a particle diameter; < 0: none
  long num_contacts = 0;
  Eigen::Vector3d plane_force = Eigen::Vector3d::Zero();   // N, of planes on bodies
  Eigen::Vector3d plane_torque = Eigen::Vector3d::Zero();  // N m, the same about the origin
  void add(const ContactSums& other);
};

/// Work (J) and loads from outside, over the bodies of one block.
struct BodySums {
  double kinetic_energy = 0;
  double mean_kinetic_energy = 0;  // at the mean velocities of a kick
  double damping_work = 0, friction_work = 0, outside_work = 0;
  double mass = 0;                                             // kg, of free bodies
  Eigen::Vector3d mass_moment = Eigen::Vector3d::Zero();       // kg m, sum of mass * position
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();          // kg m/s
  Eigen::Vector3d angular_momentum = Eigen::Vector3d::Zero();  // kg m^2/s, about the origin
  // From outside on free bodies, gravity and planes not counted.
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // N
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // N m, about the origin
  double force_size = 0, torque_size = 0;            // sums of sizes of all loads
  int unusable_body = -1;                            // the first whose load is not finite
  void add(const BodySums& other);
};

/// The number of bodies whose sums are taken together; fixed, so that sums do not depend on the
/// number of threads.
constexpr int kBodyBlock = 64;

struct Balance {
  // Now (J, kg m/s). Free bodies only.
  double kinetic_energy = 0, potential_energy = 0, elastic_energy = 0;
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_momentum = Eigen::Vector3d::Zero();  // about the origin

  // At the start.
  double energy_start = 0;
  Eigen::Vector3d momentum_start = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_momentum_start = Eigen::Vector3d::Zero();

  // Energy with the velocities in the middle of the last kick, and its first value. Semi-implicit
  // Euler holds velocities half a step behind positions, which alone makes the plain energy of a
  // spring swing by dt omega / 2; this one does not, so it is the one to watch for a gain.
  double centred_energy = 0, centred_energy_start = 0;
  double outside_work_before = 0;  // work that had been put in by then
  bool has_centred_start = false;

  // Since the start: integrals of force times velocity along each step, and of force.
  double damping_work = 0, friction_work = 0, outside_work = 0;
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_impulse = Eigen::Vector3d::Zero();
  double impulse_size = 0, angular_impulse_size = 0;

  // Extremes since the start.
  double max_kinetic_energy = 0, max_elastic_energy = 0;
  double min_potential_energy = 0, max_potential_energy = 0;
  double max_overlap = 0;
  long max_contacts = 0;

  // Over all evaluations, for the mean.
  double overlap_total = 0;
  double squared_overlap_total = 0;
  double contacts_total = 0;

  ContactSums contacts;                     // of the last evaluation
  BodySums loads;                           // of the last evaluation: force, torque and their sizes
  std::vector<ContactSums> contact_blocks;  // scratch
  std::vector<BodySums> body_blocks;        // scratch

  double energy() const { return kinetic_energy + potential_energy + elastic_energy; }
  double energy_scale() const {
    return max_kinetic_energy + (max_potential_energy - min_potential_energy) + max_elastic_energy;
  }
  /// Rise of the energy beyond the start and the work put in from outside (J).
  double energy_gain() const { return centred_energy - centred_energy_start - outside_work_before; }
  /// Signed sum of the energy balance (J); 0 if every term is right.
  double energy_residual() const {
    return energy() - energy_start + damping_work + friction_work - outside_work;
  }
};

/// Sums work(block sums, first body, end body) over all bodies, in an order that does not depend
/// on the number of threads.
template <class Work>
BodySums sum_over_bodies(std::vector<BodySums>& blocks, int num_bodies, ThreadPool& pool,
                         const Work& work) {
  blocks.resize(static_cast<std::size_t>((num_bodies + kBodyBlock - 1) / kBodyBlock));
  pool.run_ranges(num_bodies, kBodyBlock, [&](int begin, int end) {
    for (int first = begin; first < end; first += kBodyBlock) {
      BodySums sums;
      work(sums, first, first + kBodyBlock < end ? first + kBodyBlock : end);
      blocks[static_cast<std::size_t>(first / kBodyBlock)] = sums;
    }
  });
  BodySums total;
  for (const BodySums& block : blocks) total.add(block);
  return total;
}

/// Adds mass, energy and momentum of the free ones among bodies [begin, end).
void audit(const Bodies& bodies, int begin, int end, BodySums& sums);

/// Takes over energies, momentum and outside loads of the present state.
void book_state(Balance& balance, const BodySums& now, const Eigen::Vector3d& gravity);
/// Takes over the energy in the middle of a kick from the state booked last.
void book_centred_energy(Balance& balance, double kinetic_energy);
/// Adds work done during a kick.
void book_work(Balance& balance, const BodySums& done);
/// Adds the impulse of the booked outside loads over `duration` (s).
void book_impulse(Balance& balance, double duration);
/// Adds the present contacts to the means and extremes over steps.
void count_step(Balance& balance);

/// Makes the present state the start of the books.
void open_books(Balance& balance);

}  // namespace verisim::dem
