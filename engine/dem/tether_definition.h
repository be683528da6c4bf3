// SPDX-License-Identifier: MIT
// Tethers as a scene gives them, checked and made into the lines of islands.
#pragma once

#include <string>
#include <vector>

#include "dem/island.h"

namespace verisim::dem {

/// What is wrong with a tether; empty if nothing is.
std::string fault_of_tether(const TetherDefinition& tether,
                            const std::vector<BodyDefinition>& bodies);

/// The lines of a definition without faults, between bodies of the world. What does not move holds
/// a line as the world does. A line that starts at its full length is taut, a joint sits where its
/// body starts.
std::vector<Tether> make_tethers(const WorldDefinition& definition);

}  // namespace verisim::dem
