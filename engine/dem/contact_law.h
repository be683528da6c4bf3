// SPDX-License-Identifier: MIT
// The contact law of method `seed`: linear spring, dashpot, viscous tangential force.
#pragma once

#include <cmath>

#include "dem/definition.h"

namespace verisim::dem {

// Source: Harada 2007, "Real-Time Rigid Body Simulation on GPUs", GPU Gems 3, chapter 29:
//   spring  F_s = -k (d - |r|) r / |r|,  dashpot  F_d = eta v,  shear  F_t = k_t v_t.
// As there, the normal force is not clamped: while two particles part, the dashpot may outweigh
// the spring and pull (a short attractive tail).
// Deviations: the forces act at the contact point (middle of the overlap) and use the velocities
// there; the source lets them act at the particle centres, which loses angular momentum between
// the bodies and cannot spin a body of one particle. The dashpot uses the normal part of the
// velocity only, the shear force the rest, so that each has its own coefficient.

/// Coefficients for all contacts; a contact's own are these times the root of its effective mass.
struct ContactLaw {
  double stiffness;        // N/m
  double damping_rate;     // N s/m per sqrt(kg): ratio * 2 sqrt(k)
  double tangential_rate;  // N s/m per sqrt(kg)
};

/// A dashpot of ratio 1 is critical for one contact between two particles of that effective mass:
/// c = 2 sqrt(k m_eff). The body behind a particle is heavier, so its contact is damped less.
inline ContactLaw contact_law(const SeedSettings& settings) {
  const double critical = 2 * std::sqrt(settings.stiffness);
  return {settings.stiffness, settings.damping_ratio * critical,
          settings.tangential_damping_ratio * critical};
}

/// Effective mass (kg) of two particles; an infinite mass is written as inverse 0.
inline double effective_mass(double inverse_mass_i, double inverse_mass_j) {
  return 1 / (inverse_mass_i + inverse_mass_j);
}

}  // namespace verisim::dem
