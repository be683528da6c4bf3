// SPDX-License-Identifier: MIT
// What a run reports about itself: energies, work, penetration, contact events and failures.
#pragma once

#include <Eigen/Core>
#include <string>

namespace verisim::dem {

/// Where the work of method dem went.
struct WorkSplit {
  long num_steps = 0;           // of all islands together, explicit and implicit ones
  long num_implicit_steps = 0;  // of them
  long num_refused_steps = 0;   // implicit steps taken back, not counted above
  long num_newton_steps = 0;    // in all implicit steps
};

/// Summary of a run so far. Energies are those of the free bodies; potential energy is zero at the
/// world's origin. Names follow `verisim simulate --json`.
struct Metrics {
  double max_penetration_m = 0;              // deepest overlap of any contact
  double mean_penetration_m = 0;             // over all contacts of all steps
  double rms_penetration_m = 0;              // the same
  double max_penetration_rel = 0;            // of the smallest extent of the smallest free body
  double anchor_creep_m = 0;                 // method dem; largest of any contact that stuck
  double energy_start_j = 0;                 // kinetic + potential + elastic
  double energy_end_j = 0;                   //
  double kinetic_energy_j = 0;               // at the end
  double potential_energy_j = 0;             // at the end
  double elastic_energy_j = 0;               // at the end
  double damping_work_j = 0;                 // taken out by the normal dashpots
  double implicit_work_j = 0;                // the part of it that implicit steps took
  double correction_work_j = 0;              // the part of it that corrected positions took
  double friction_work_j = 0;                // taken out by the tangential force
  double outside_work_j = 0;                 // put in by drag, prescribed motion and live edits
  double energy_residual_rel = 0;            // |sum of the balance| / energy_scale_j
  double energy_scale_j = 0;                 // max kinetic + range of potential + max elastic
  double momentum_residual_rel = 0;          // linear, over the sum of |impulse|
  double angular_momentum_residual_rel = 0;  // about the origin, over the sum of |its impulse|
  double energy_rise_j = 0;                  // largest of one implicit step or substep
  long num_particles = 0;                    // of method seed
  long num_samples = 0;                      // surface points of method dem
  WorkSplit work;                            // of method dem
  long max_contacts = 0;                     // particle contacts at one time
};

enum class ContactChange { kBegin, kEnd };

/// Two bodies, or a body and a plane, start or stop touching.
struct ContactEvent {
  ContactChange change = ContactChange::kBegin;
  double time = 0;   // s
  int body_a = -1;   // index in file order
  int body_b = -1;   // > body_a; -1 if the other side is a plane
  int plane = -1;    // index; -1 if the other side is a body
  double speed = 0;  // m/s along the normal: of approach at the begin, of separation at the end
  double sliding_speed = -1;  // m/s across it; method dem
};

/// Why a run is not to be trusted. Codes: nonfinite, energy_gain, penetration, pass_through; and,
/// where an expectation says so, toppled, sank, drifted, jitters.
struct Failure {
  std::string code;
  std::string body;  // name; empty if no single body is to blame
  long step = 0;     // steps done when it was seen
  double time = 0;   // s
  std::string message;
};

}  // namespace verisim::dem
