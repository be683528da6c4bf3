// SPDX-License-Identifier: MIT
// Method `xpbd`: rigid contacts by position-level small steps on the same contact points as `dem`.
#pragma once

#include "dem/island.h"

namespace verisim::dem {

/// Advances to `end` (s). An island in which nothing touches flies exactly to the next touch-down;
/// one in contact takes substeps of settings.substep: positions are corrected until surfaces no
/// longer overlap, velocities follow from the corrections, and a velocity pass stops what still
/// approaches and slides. Whatever meets faster than settings.restitution_threshold is an impact
/// (xpbd_impacts.h). Sources: Mueller et al. 2020 (substeps, friction, threshold); Macklin et al.
/// 2019 (one iteration per substep). Deviations: engine/README.md.
void advance_xpbd(Island& island, double end, const ContactSettings& settings);

}  // namespace verisim::dem
