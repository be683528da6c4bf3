// SPDX-License-Identifier: MIT
// The stiffest spring that method `dem` chose in a run, and why.
#pragma once

namespace verisim::dem {

/// What made the stiffest spring as stiff as it is.
enum class StiffnessBound { kNone, kImpact, kLoad, kNamed };

struct HardestContact {
  double stiffness = 0;              // N/m, of a point of weight 1
  double predicted_penetration = 0;  // m, deepest that approach speeds and loads give any pair
  StiffnessBound bound = StiffnessBound::kNone;

  /// Takes over what is stiffer or deeper in `other`.
  void include(const HardestContact& other) {
    if (other.stiffness > stiffness) {
      stiffness = other.stiffness;
      bound = other.bound;
    }
    if (other.predicted_penetration > predicted_penetration) {
      predicted_penetration = other.predicted_penetration;
    }
  }
};

}  // namespace verisim::dem
