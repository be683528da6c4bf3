// SPDX-License-Identifier: MIT
// All forces at the present places and velocities, as a list of phases.
#pragma once

#include "dem/world.h"

namespace verisim::dem {

/// Sets the loads of all bodies, lets them act for `kick_duration` (s), notes contacts that began
/// or ended, and books energies and momentum. Returns what load_bodies does.
int evaluate_forces(World& world, double kick_duration);

}  // namespace verisim::dem
