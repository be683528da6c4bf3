// SPDX-License-Identifier: MIT
// Of method `xpbd`: which pairs touch, and who begins and ends to.
#pragma once

#include "dem/island.h"

namespace verisim::dem {

/// How far apart (m) points of touching pairs are still looked at: as high as a hop at the
/// threshold of restitution rises.
double look_gap(const ContactSettings& settings);

/// Begins the contact of a pair that has met and is no impact; ends one whose points all part
/// faster than the threshold of restitution or are farther apart than a hop at that speed rises.
void update_touching(LocalPair& local, Island& island, const ContactSettings& settings);

/// Begins the contact of a pair that touches from now on, `speed` its approach (m/s).
void begin_touching(LocalPair& local, Island& island, double speed);

}  // namespace verisim::dem
