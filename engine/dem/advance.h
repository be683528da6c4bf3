// SPDX-License-Identifier: MIT
// Moves bodies: kicks change momenta by forces, drifts change places by velocities.
#pragma once

#include "dem/world.h"

namespace verisim::dem {

/// Lets the present loads act for `duration` (s) and books their work and impulse.
/// Work is the load times the mean of the velocities before and after: with that, a kick's change
/// of kinetic energy is split exactly, and the balance closes as dt falls.
void kick(World& world, double duration);

/// Moves and turns every body for `duration` (s) at its present momenta; prescribed bodies go to
/// where their path has them at the new time.
void drift(World& world, double duration);

}  // namespace verisim::dem
