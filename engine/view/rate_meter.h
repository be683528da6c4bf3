// SPDX-License-Identifier: MIT
// Frame rate and speed against the clock on the wall, over the last second.
#pragma once

#include <deque>

namespace verisim::view {

class RateMeter {
 public:
  /// One frame: it took `wall` seconds and advanced the simulation by `simulated` seconds.
  void add(double wall, double simulated);
  double frames_per_second() const;
  /// Simulated seconds per second.
  double real_time_factor() const;

 private:
  struct Frame {
    double wall, simulated;  // s
  };
  std::deque<Frame> frames_;
  double wall_ = 0, simulated_ = 0;  // sums
};

}  // namespace verisim::view
