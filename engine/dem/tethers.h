// SPDX-License-Identifier: MIT
// Inextensible lines that hold bodies: they pull, never push, and may hang slack.
#pragma once

#include <functional>
#include <vector>

#include "dem/island.h"

namespace verisim::dem {

// A tethered island takes explicit steps alone. Each of them is that of RATTLE (Andersen 1983;
// with rotation: Leimkuhler and Reich 2004): an impulse along every taut line before the drift
// such that its length is right after it, and one after the last kick such that its length does
// not change. A line whose impulse would push hangs slack. A slack line that becomes taut ends the
// step at that moment and takes the speed along it, without rebound; the books take the energy. A
// line without length is a ball joint: three constraints that may pull and push.

/// Longest step (s) over which tethered bodies swing and turn little. Sets the bodies'
/// other_acceleration.
double tether_step(Island& island, const Eigen::Vector3d& gravity);

/// Slack lines at full length that lengthen become taut.
void tighten(Island& island);

/// Calls `kick` for a step of at most `step` (s), moves the free bodies through it with all taut
/// lines at their length, and returns its duration: shorter if a slack line becomes taut.
double drift_on_tethers(Island& island, double step, const std::function<void(double)>& kick);

/// Takes the speeds along taut lines that the forces of the second half of a step gave.
void hold_velocities(Island& island);

}  // namespace verisim::dem
