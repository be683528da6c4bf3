// SPDX-License-Identifier: MIT
// Sums forces to bodies: from their particles, gravity, and whoever pulls from outside.
#pragma once

#include "dem/world.h"

namespace verisim::dem {

/// Sets the loads of all bodies from `world.rows`, in the order of their particles, lets them act
/// for `kick_duration` (s), and books energies and momentum. Returns the first body whose load is
/// not finite (or beyond 1e100, from where the next step could leave the range of numbers), or -1;
/// then nothing is booked, and that body is not kicked.
int load_bodies(World& world, double kick_duration);

}  // namespace verisim::dem
