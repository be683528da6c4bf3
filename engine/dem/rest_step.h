// SPDX-License-Identifier: MIT
// One implicit step of an island that rests, slides or rolls: the same springs and stretches as
// the explicit step, advanced by backward Euler.
#pragma once

#include "dem/island.h"

namespace verisim::dem {

/// Advances by `duration` (s) if the step is good: converged, without rise of energy. Otherwise
/// the island is left as it was and the result is false; try a shorter step.
bool rest_step(Island& island, double duration, const ContactSettings& settings);

}  // namespace verisim::dem
