// SPDX-License-Identifier: MIT
// The loop around step: samples poses, collects metrics and events, and judges the run.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "dem/hardest_contact.h"
#include "dem/last_moments.h"
#include "dem/metrics.h"
#include "dem/pose_log.h"
#include "dem/world.h"

namespace verisim::dem {

/// What a right run does: these bodies end upright and at their place, at rest.
struct Expectation {
  std::vector<int> stands;  // body indices
};

struct RunOptions {
  double duration = 0;         // s, from the world's present time
  double sample_interval = 0;  // s; poses are logged at 0, 1, 2 ... intervals
  std::vector<Expectation> expect;
  double keep_before_failure = 0;  // s, of states and contacts that lead to the first failure
  std::function<void(double time)> progress;  // called after each sample, may be empty
};

struct RunResult {
  PoseLog log;
  Metrics metrics;
  std::vector<ContactEvent> events;
  std::optional<Failure> failed;  // the first failure
  std::vector<Failure> failures;  // the first of each code, in the order they were seen
  long steps = 0;
  double dt = 0;           // s, the smallest used
  double cpu_s = 0;        // CPU time of stepping alone, all threads
  HardestContact hardest;  // of method `dem`
  LastMoments last;        // of a failed run, as long as asked for
};

/// Advances `world` by `duration`. Steps are of the world's dt; sample times between two steps are
/// reached by interpolating the poses at both. A run goes on after a failure, except after
/// `nonfinite` and after an explosion (energy beyond 1000 times its scale): then the log ends early
/// and `world` holds the last good state.
RunResult run(World& world, const RunOptions& options);

}  // namespace verisim::dem
