// SPDX-License-Identifier: MIT
// Rigid impacts at velocity level: what meets faster than the threshold of restitution.
#pragma once

#include <vector>

#include "dem/island.h"

namespace verisim::dem {

/// A point that came into contact within the last substep, faster than the threshold.
struct FreshPoint {
  int pair = 0, point = 0;  // in Island::pairs, ContactPair::points
};

/// Resolves impacts at the present places, pair after pair until no point that has met approaches
/// faster than the threshold: the points of a pair part with the pair's restitution times the speed
/// at which each approached before (Newton; Mueller et al. 2020, eq. 34), with Coulomb friction
/// that stops what it can. Where friction would make such an impact gain energy its restitution is
/// lowered to that which keeps it. `fresh` points, in order of pairs, met within the substep: their
/// impact acts as of that moment, positions take what follows from it until now.
void resolve_impacts(Island& island, const std::vector<FreshPoint>& fresh,
                     const ContactSettings& settings);

}  // namespace verisim::dem
