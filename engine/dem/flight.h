// SPDX-License-Identifier: MIT
// How bodies move between contacts, and how soon two of them can meet.
#pragma once

#include <algorithm>

#include "dem/island.h"

namespace verisim::dem {

/// Bound on how fast (m/s) and how much faster still (m/s^2) the bodies of a pair can close in.
struct Approach {
  double speed, acceleration;
};

/// Along the axis that separates a pair, where there is one; else in any direction.
Approach approach_of(const LocalPair& local, const Island& island, const Eigen::Vector3d& gravity);

/// The same in any direction.
Approach fastest_approach(const LocalPair& local, const Island& island,
                          const Eigen::Vector3d& gravity);

/// Earliest time (s) at which `gap` (m) can be closed; infinite if never.
double time_to_close(double gap, const Approach& approach);

/// True if `gap` (m) surely stays open for `duration` (s).
inline bool stays_open(double gap, const Approach& approach, double duration) {
  const double way = std::max(0.0, approach.speed) * duration +
                     std::max(0.0, approach.acceleration) * duration * duration;
  return gap > way;
}

/// Fastest that the turning of a body moves its surface (m/s); 0 for a sphere, whose surface stays.
inline double edge_speed(const BodyState& body) {
  if (std::holds_alternative<SphereShape>(*body.shape)) return 0;
  return body.spin.norm() * body.reach;
}

/// Moves a body through `duration` (s) without forces on its rotation: fourth order, in pieces
/// that turn little enough.
void drift_body(BodyState& body, double duration);

/// Puts a prescribed body where its path is at `time` (s).
void follow_path(BodyState& body, double time);

}  // namespace verisim::dem
