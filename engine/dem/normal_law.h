// SPDX-License-Identifier: MIT
// The normal force of a contact point by the law that a scene names.
#pragma once

#include "dem/island.h"

namespace verisim::dem {

/// Spring and damper of one point at its present compression. The force is
/// max(0, force + stiffness * relaxation * closing speed): contacts do not pull.
struct NormalSpring {
  double force = 0;       // N
  double energy = 0;      // J
  double stiffness = 0;   // N/m, tangent
  double relaxation = 0;  // s, damping over stiffness
};

/// At `compression` (m, > 0) of a point of weight `weight`, all touching points of the pair
/// together weighing `total_weight`.
/// hunt_crossley  k x, damping k x d / v0 with v0 the approach speed of the pair (Hunt and Crossley
///                1975); d from restitution.h
/// linear         k x, damping 2 zeta sqrt(k m), m the mass that the bodies present to each other,
///                rotation left aside; shared by the points (Schwager and Poeschel 2007: clamped)
/// hertz_mindlin  4/3 E* sqrt(R*) x^(3/2), damping alpha sqrt(m K) x^(1/4) (Tsuji et al. 1992)
NormalSpring normal_spring(const LocalPair& local, double weight, double total_weight,
                           double compression, double inverse_mass, NormalLaw law);

/// Stiffness (N/m) of the linear spring whose contact lasts as long as Hertz's at this approach
/// speed (m/s), or the tangent at `depth` (m) if that is deeper than such an impact: what steps are
/// chosen by.
double hertz_step_stiffness(const PairLaw& law, double mass, double speed, double depth);

/// Deepest compression (m) of an elastic impact by Hertz's law: (5 m v^2 / (4 K))^(2/5).
double hertz_depth(double hertz, double mass, double speed);

/// Damping factor of a law that returns the restitution exactly at `steps` explicit steps per
/// elastic contact: d, zeta or alpha of normal_spring.
double damping_factor(NormalLaw law, double restitution, int steps);

/// Restitution of the discrete impact with that factor.
double discrete_restitution(NormalLaw law, double factor, int steps);

/// The zeta with which a clamped linear spring and dashpot return e in continuous time: the inverse
/// of e = exp(-(zeta/w)(pi - atan2(2 zeta w, w^2 - zeta^2))), w = sqrt(1 - zeta^2), and of its
/// continuation beyond 1 (Schwager and Poeschel 2007).
double linear_damping_ratio(double restitution);

struct Elastic {
  double young_modulus;  // Pa
  double poisson_ratio;
};
/// Sets the pair's constants of Hertz and Mindlin; its radius is set.
void set_hertz(PairLaw& law, const Elastic& a, const Elastic& b);

}  // namespace verisim::dem
