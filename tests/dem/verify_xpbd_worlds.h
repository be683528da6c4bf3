// SPDX-License-Identifier: MIT
// Worlds of the verification suite of method xpbd.
#pragma once

#include "verify_worlds.h"

namespace verisim::dem::testing {

/// The same world with method xpbd.
VERISIM_OUT_OF_LINE WorldDefinition by_xpbd(WorldDefinition definition, int substeps = 20) {
  definition.method = Method::kXpbd;
  definition.xpbd.substeps = substeps;
  return definition;
}

/// Fastest body (m/s) over the last `duration` (s) of a run.
VERISIM_OUT_OF_LINE double late_speed(const Watched& watched, double duration) {
  const PoseLog& log = watched.result.log;
  double fastest = 0;
  for (std::size_t t = 0; t < log.num_times(); ++t) {
    if (log.times[t] < log.times.back() - duration) continue;
    for (std::size_t b = 0; b < log.num_bodies(); ++b) {
      fastest = std::max(fastest, log.at(t, b).linear_velocity.norm());
    }
  }
  return fastest;
}

}  // namespace verisim::dem::testing
