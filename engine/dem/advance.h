// SPDX-License-Identifier: MIT
// Moves bodies: kicks change momenta by forces, drifts change places by velocities.
#pragma once

#include "dem/world.h"

namespace verisim::dem {

/// Lets the present loads act on bodies [begin, end) for `duration` (s) and adds their work to
/// `sums`. Work is the load times the mean of the velocities before and after: with that, a kick's
/// change of kinetic energy is split exactly, and the balance closes as dt falls.
void kick(World& world, int begin, int end, double duration, BodySums& sums);

/// Kicks all bodies for `kick_duration`, then moves and turns them for `drift_duration` at their
/// new momenta; prescribed bodies go to where their path has them at the new time.
void move_bodies(World& world, double kick_duration, double drift_duration);

}  // namespace verisim::dem
