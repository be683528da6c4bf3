// SPDX-License-Identifier: MIT
// Pose and velocity of a body that follows given poses.
#pragma once

#include "dem/definition.h"

namespace verisim::dem {

/// Pose and velocities at `time` (s). At rest before the first and after the last given time.
/// Cost: logarithmic in the number of poses.
Pose pose_at(const PrescribedMotion& motion, double time);

}  // namespace verisim::dem
