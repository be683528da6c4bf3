// SPDX-License-Identifier: MIT
// Damping that gives a chosen coefficient of restitution (Hunt and Crossley 1975).
#pragma once

namespace verisim::dem {

/// Least restitution that explicit contacts are damped for: below it the damping would have to be
/// stiffer than the spring, and the rebound is out of sight.
constexpr double kLeastRestitution = 0.02;

/// The d of F = k x (1 + d x'/v0) that returns the share e of the approach speed v0, whatever k,
/// the mass and the number of contacts: ln((1 + d) / (1 - e d)) = d (1 + e), in (0, 1/e); 0 at 1.
/// Restitutions below kLeastRestitution count as that.
double hunt_crossley_factor(double restitution);

/// Step (of sqrt(m/k)) with which an elastic kick-drift-kick impact lasts `steps` whole steps: pi
/// over it but for the scheme's own frequency. An elastic impact then keeps its speed to rounding.
double impact_step(int steps);

/// The d with which the discrete kick-drift-kick impact of `steps` steps that begins at touch-down
/// returns e exactly.
double calibrated_factor(double restitution, int steps);

/// Restitution of that discrete impact for a given d.
double discrete_restitution(double factor, int steps);

}  // namespace verisim::dem
