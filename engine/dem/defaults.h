// SPDX-License-Identifier: MIT
// Stiffness and time step for a scene that names none, from its loads and speeds.
#pragma once

#include "dem/definition.h"

namespace verisim::dem {

/// Contact settings for `definition` (its own `seed` and `dt` are not read).
///
/// With d the particle diameter of a free body, n the particles of its largest face, W the weight
/// of the body and of all free bodies in the column above it, M its mass, v its greatest speed
/// (start speed, and the fall to the lowest support):
///   static  n k (d / 100) >= W   full overlap of the face, n k d = W, is the crush limit
///   impact  k (d / 4)^2 >= M v^2   one particle alone stops the body in a quarter diameter
/// k is the greatest over bodies. damping_ratio 1 (critical, as in the source) and
/// tangential_damping_ratio 0.5. Cost: quadratic in the number of free bodies.
SeedSettings default_seed_settings(const WorldDefinition& definition);

/// Time step (s) for the settings in `definition.seed`.
///
/// Blow-up sets in near dt = 1 / sqrt(n k / M). Least over free bodies of
///   0.1 / omega,  omega^2 = k max(n / M, 1 / M + R^2 / I_min)
///   0.4 / gamma,  gamma = (damping rate of the same contacts)
///   d / (4 v)     so that nothing passes a particle unseen
/// with R the farthest particle from the centre of mass; a one-particle body counts n = 6.
double default_dt(const WorldDefinition& definition);

}  // namespace verisim::dem
