// SPDX-License-Identifier: MIT
// All forces on all bodies at the present places and velocities.
#pragma once

#include "dem/world.h"

namespace verisim::dem {

/// Sets the loads of all bodies and the contact sums of the balance; notes contacts that began or
/// ended. Returns the first body whose load is not finite (or beyond 1e100, from where the next
/// step could leave the range of numbers), or -1.
int evaluate_forces(World& world);

}  // namespace verisim::dem
