// SPDX-License-Identifier: MIT
#include "view/rate_meter.h"

namespace verisim::view {

void RateMeter::add(double wall, double simulated) {
  constexpr double kWindow = 1;  // s
  frames_.push_back({wall, simulated});
  wall_ += wall;
  simulated_ += simulated;
  while (frames_.size() > 1 && wall_ - frames_.front().wall >= kWindow) {
    wall_ -= frames_.front().wall;
    simulated_ -= frames_.front().simulated;
    frames_.pop_front();
  }
}

double RateMeter::frames_per_second() const {
  return wall_ > 0 ? static_cast<double>(frames_.size()) / wall_ : 0;
}

double RateMeter::real_time_factor() const { return wall_ > 0 ? simulated_ / wall_ : 0; }

}  // namespace verisim::view
