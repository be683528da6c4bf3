// SPDX-License-Identifier: MIT
#include "dem/flight.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dem/prescribed.h"
#include "dem/rotation.h"

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

// Turn (rad) of one rotation step: its energy error is then 1e-9 over a hundred radians.
constexpr double kTurn = 0.03;

}  // namespace

Approach approach_of(const LocalPair& local, const Island& island, const Vector3d& gravity) {
  if (!local.pair.gap_is_along_normal) return fastest_approach(local, island, gravity);
  const BodyState& a = island.bodies[static_cast<std::size_t>(local.a)];
  const BodyState& b = island.bodies[static_cast<std::size_t>(local.b)];
  const double other = a.other_acceleration + b.other_acceleration;
  double pull = 0;  // apart
  if (a.is_free() != b.is_free()) {
    pull = (a.is_free() ? 1 : -1) * local.pair.gap_normal.dot(gravity);
  }
  return {edge_speed(a) + edge_speed(b) - local.pair.gap_normal.dot(a.velocity - b.velocity),
          other - pull};
}

double time_to_close(double gap, const Approach& approach) {
  const double a = approach.acceleration, v = approach.speed;
  if (gap <= 0) return 0;
  const double root = v * v + 2 * a * gap;
  if (root < 0) return std::numeric_limits<double>::infinity();
  const double denominator = v + std::sqrt(root);
  return denominator > 0 ? 2 * gap / denominator : std::numeric_limits<double>::infinity();
}

Approach fastest_approach(const LocalPair& local, const Island& island, const Vector3d& gravity) {
  const BodyState& a = island.bodies[static_cast<std::size_t>(local.a)];
  const BodyState& b = island.bodies[static_cast<std::size_t>(local.b)];
  const double pull = a.is_free() == b.is_free() ? 0 : gravity.norm();
  return {(a.velocity - b.velocity).norm() + edge_speed(a) + edge_speed(b),
          pull + a.other_acceleration + b.other_acceleration};
}

void follow_path(BodyState& body, double time) {
  const Pose pose = pose_at(*body.path, time);
  body.position = pose.position;
  body.orientation = pose.orientation;
  body.velocity = pose.linear_velocity;
  body.spin = pose.angular_velocity;
  refresh(body);
  body.path_low = body.path_low.cwiseMin(body.position);
  body.path_high = body.path_high.cwiseMax(body.position);
}

void drift_body(BodyState& body, double duration) {
  body.position += duration * body.velocity;
  body.path_low = body.path_low.cwiseMin(body.position);
  body.path_high = body.path_high.cwiseMax(body.position);
  if (body.spin.isZero(0)) return;
  if (body.inverse_inertia_all_axes > 0) {
    body.orientation = (rotation_of(duration * body.spin) * body.orientation).normalized();
  } else {
    const double turn = body.spin.norm() * duration;
    const int pieces = std::max(1, static_cast<int>(std::ceil(turn / kTurn)));
    for (int i = 0; i < pieces; ++i) {
      body.orientation = turn_by_rkmk4(body.orientation, body.inverse_inertia_b,
                                       body.angular_momentum, duration / pieces);
    }
  }
  refresh(body);
}

}  // namespace verisim::dem
