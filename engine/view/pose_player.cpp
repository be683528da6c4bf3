// SPDX-License-Identifier: MIT
#include "view/pose_player.h"

#include <algorithm>

namespace verisim::view {

PosePlayer::PosePlayer(dem::PoseLog log) : log_(std::move(log)) { seek(0); }

void PosePlayer::advance(double seconds) {
  // A frame is due a hair before its time, so that sums of intervals do not miss it by rounding.
  constexpr double kRounding = 1e-9;  // s
  clock_ = std::min(clock_ + seconds, end());
  while (!at_end() && log_.times[frame_ + 1] <= clock_ + kRounding) ++frame_;
}

void PosePlayer::step(int frames) { seek(frame_ + frames); }

void PosePlayer::seek(int frame) {
  frame_ = std::clamp(frame, 0, num_frames() - 1);
  clock_ = log_.times[frame_];
}

std::span<const dem::Pose> PosePlayer::poses() const {
  return std::span(log_.poses).subspan(frame_ * log_.num_bodies(), log_.num_bodies());
}

}  // namespace verisim::view
