// SPDX-License-Identifier: MIT
// Conventions of the physics: units, frames, signs, and the named choices a scene can make.
#pragma once

#include <string_view>

namespace verisim::dem {

// Units: SI everywhere (m, kg, s, rad, N, J). Right-handed, z up, gravity usually (0, 0, -9.81).
// Frames: world unless a name ends in `_b` (body: origin at the centre of mass, axes of the mesh).
// Rotation q_wb takes body to world: v_w = q_wb * v_b. `normal` points from j to i; a positive
// normal force pushes i along it. `overlap` > 0 where particles touch.

/// How a body moves: by forces, not at all, or along given poses whatever pushes it.
enum class Motion { kFree, kFixed, kPrescribed };

/// How contact is modelled. Scene names: "dem", "seed", "xpbd".
enum class Method { kDem, kSeed, kXpbd };

/// Methods whose bodies meet as surfaces; those of the other are filled with particles.
constexpr bool has_surfaces(Method method) { return method != Method::kSeed; }

/// How time advances. Scene names: "seed", "rkmk4".
enum class Integrator { kSeed, kRkmk4 };

/// Normal force of method dem. Scene names: "hunt_crossley", "linear", "hertz_mindlin".
enum class NormalLaw { kHuntCrossley, kLinear, kHertzMindlin };

/// Friction of method dem below Coulomb's limit. Scene names: "spring", "rigid_stick".
enum class TangentialLaw { kSpring, kRigidStick };

constexpr std::string_view to_string(Integrator integrator) {
  return integrator == Integrator::kSeed ? "seed" : "rkmk4";
}

constexpr std::string_view to_string(Method method) {
  if (method == Method::kXpbd) return "xpbd";
  return method == Method::kDem ? "dem" : "seed";
}

}  // namespace verisim::dem
