// SPDX-License-Identifier: MIT
// How bodies move between contacts, and how soon two of them can meet.
#pragma once

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

/// Fastest that the turning of a body moves its surface (m/s); 0 for a sphere, whose surface stays.
inline double edge_speed(const BodyState& body) {
  if (std::holds_alternative<SphereShape>(*body.shape)) return 0;
  return body.spin.norm() * body.reach;
}

/// A pair whose every corner is followed by itself: a free box over a plane. Bounds by the speed of
/// edges would take a hundred steps where a corner grazes the plane.
bool has_corners(const LocalPair& local, const Island& island);

/// Exact gap (m) of such a pair.
double corner_gap(const LocalPair& local, const Island& island);

/// Earliest time (s), at most `longest`, at which a corner of such a pair can meet the plane.
double time_to_land(const LocalPair& local, const Island& island, const Eigen::Vector3d& gravity,
                    double longest);

/// `time_to_close`, at most `longest` (s).
double close_within(double longest, double gap, const Approach& approach);

/// Moves a body through `duration` (s) without forces on its rotation: fourth order, in pieces
/// that turn little enough.
void drift_body(BodyState& body, double duration);

/// Puts a prescribed body where its path is at `time` (s).
void follow_path(BodyState& body, double time);

}  // namespace verisim::dem
