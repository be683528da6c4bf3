// SPDX-License-Identifier: MIT
// Whether contacts that stick stay where they are.
#pragma once

#include "dem/body_state.h"
#include "dem/contact_pair.h"

namespace verisim::dem {

/// Longest way (m) across its normal that a point of the pair crept since it last slid: how far the
/// two places that gripped each other then are apart now, less what its tangential spring stretched
/// meanwhile. Points that slid since the last call grip anew. 0 for spheres: they roll.
double follow_anchors(ContactPair& pair, const BodyState& a, const BodyState& b);

}  // namespace verisim::dem
