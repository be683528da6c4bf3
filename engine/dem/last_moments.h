// SPDX-License-Identifier: MIT
// What led to a failure: states and contacts of the last moments before it.
#pragma once

#include <deque>
#include <vector>

#include "dem/pose_log.h"
#include "dem/world.h"

namespace verisim::dem {

/// A place where two bodies overlapped at a time.
struct ContactRecord {
  double time = 0;                                    // s, one of the log's
  int a = -1, b = -1;                                 // bodies; a plane p is body B + p
  Eigen::Vector3d place = Eigen::Vector3d::Zero();    // m, world
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, pushes a away from b
  double depth = 0;                                   // m
  double load = 0;  // N, normal force; of `seed` the spring's part
};

struct LastMoments {
  PoseLog log;
  std::vector<ContactRecord> contacts;  // in order of time
};

/// Keeps the states of the last `duration` seconds, no two closer than a millisecond.
class MomentKeeper {
 public:
  explicit MomentKeeper(double duration) : duration_(duration) {}

  /// Keeps the present state of the world and forgets those that are too old.
  void note(const World& world);
  LastMoments take(const World& world) &&;

 private:
  struct Moment {
    double time;
    std::vector<Pose> poses;
    std::vector<ContactRecord> contacts;
  };
  double duration_;
  std::deque<Moment> moments_;
};

/// Every place where bodies overlap now.
std::vector<ContactRecord> contacts_of(const World& world);

}  // namespace verisim::dem
