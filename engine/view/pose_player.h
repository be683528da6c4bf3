// SPDX-License-Identifier: MIT
// Plays a pose log: a place in it that runs, stops and steps frame by frame.
#pragma once

#include <span>

#include "dem/pose_log.h"

namespace verisim::view {

class PosePlayer {
 public:
  /// The log must hold at least one time.
  explicit PosePlayer(dem::PoseLog log);

  /// Runs on by `seconds` of the log's time; stops at its end.
  void advance(double seconds);
  /// Goes this many frames on, or back; stays within the log.
  void step(int frames);
  void seek(int frame);

  int frame() const { return frame_; }
  int num_frames() const { return static_cast<int>(log_.num_times()); }
  double time() const { return log_.times[frame_]; }  // s
  double end() const { return log_.times.back(); }    // s
  bool at_end() const { return frame_ + 1 == num_frames(); }
  /// One pose per body: those of the frame, nothing in between.
  std::span<const dem::Pose> poses() const;

 private:
  dem::PoseLog log_;
  int frame_ = 0;
  double clock_ = 0;  // s, runs on between frames
};

}  // namespace verisim::view
