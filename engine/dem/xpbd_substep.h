// SPDX-License-Identifier: MIT
// One substep of method `xpbd` for an island in contact.
#pragma once

#include "dem/island.h"

namespace verisim::dem {

/// Advances by `step` (s): half a kick, drift, positions corrected at their new places, half a
/// kick, velocity pass, impacts of what met on the way.
void xpbd_substep(Island& island, double step, const ContactSettings& settings);

/// Velocities take `duration` (s) of gravity, wind and loads from outside; the books as well.
void kick_freely(Island& island, double duration, const ContactSettings& settings);

}  // namespace verisim::dem
