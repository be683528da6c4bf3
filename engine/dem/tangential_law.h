// SPDX-License-Identifier: MIT
// What resists sliding and rolling at a contact point.
#pragma once

#include "dem/island.h"
#include "dem/normal_law.h"

namespace verisim::dem {

/// A point that is evaluated: where its bodies are, how they slide there, what presses them.
struct Grip {
  Eigen::Vector3d sliding;  // m/s, of a against b, across the normal
  double load;              // N
  double damping;           // N s/m, of the normal damper
  double stiffness;         // N/m, tangent of the normal spring
  int num_points;           // that share the mass of the bodies
  double drift;             // s, that led here
};

/// Force (N) on body a across the normal. The point's stretch advances by the drift. Up to
/// friction * load it is
/// spring       a spring on the stretch, tangential_ratio as stiff as the normal one and damped in
///              proportion; sliding stretches it as far as that load allows (Cundall and Strack
///              1979). With Hertz's law the ratio is Mindlin's; the force is kept where the
///              stiffness rises, the stretch where it falls, so that energy never rises
/// rigid_stick  what stops the sliding within the step, and a spring that holds what stands still;
///              while it slides the spring is at rest: impacts stick without tangential rebound.
///              Explicit steps alone
/// `sheared` takes the energy (J) that the spring holds.
Eigen::Vector3d friction_force(const LocalPair& local, ContactPoint& point, const BodyState& a,
                               const BodyState& b, const Grip& grip,
                               const ContactSettings& settings, double& sheared);

/// Torque (N m) on body a, its reverse on b, against the rolling of spheres: a spring on the way
/// rolled, as stiff as the tangential one, damped, and capped at rolling_friction * load * radius
/// (type C of Ai et al. 2011, with that stiffness in place of theirs). `sheared` as above.
Eigen::Vector3d rolling_torque(const LocalPair& local, ContactPoint& point, const BodyState& a,
                               const BodyState& b, const Grip& grip,
                               const ContactSettings& settings, double& sheared);

}  // namespace verisim::dem
