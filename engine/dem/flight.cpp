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

/// Calls visit(height above the plane, arm from the centre), in m, for each corner of a box.
template <class Visit>
void visit_corners(const BodyState& box, const BodyState& plane, const Visit& visit) {
  const Vector3d& half = std::get<BoxShape>(*box.shape).half;
  const Vector3d up = plane.rotation.col(2);
  const double centre = up.dot(box.position - plane.position);
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d corner_b((corner & 1) != 0 ? half.x() : -half.x(),
                            (corner & 2) != 0 ? half.y() : -half.y(),
                            (corner & 4) != 0 ? half.z() : -half.z());
    const Vector3d arm = box.rotation * corner_b;
    visit(centre + up.dot(arm), arm);
  }
}

/// Bound on the acceleration (m/s^2) that turning gives to the surface of a free body, at any time:
/// no spin is faster than angular momentum over the least moment of inertia.
double turning_acceleration(const BodyState& body) {
  if (body.inverse_inertia_all_axes > 0) return body.spin.squaredNorm() * body.reach;
  const double fastest = body.angular_momentum.norm() * body.inverse_inertia_b.norm();
  return 2 * fastest * fastest * body.reach;
}

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

double close_within(double longest, double gap, const Approach& approach) {
  // Most gaps are far from closing; to see that takes no root.
  const double way = std::max(0.0, approach.speed) * longest +
                     std::max(0.0, approach.acceleration) * longest * longest;
  return gap > way ? longest : std::min(longest, time_to_close(gap, approach));
}

bool has_corners(const LocalPair& local, const Island& island) {
  const BodyState& a = island.bodies[static_cast<std::size_t>(local.a)];
  const BodyState& b = island.bodies[static_cast<std::size_t>(local.b)];
  return std::holds_alternative<BoxShape>(*a.shape) && std::holds_alternative<PlaneShape>(*b.shape);
}

double corner_gap(const LocalPair& local, const Island& island) {
  double gap = std::numeric_limits<double>::infinity();
  visit_corners(island.bodies[static_cast<std::size_t>(local.a)],
                island.bodies[static_cast<std::size_t>(local.b)],
                [&](double height, const Vector3d&) { gap = std::min(gap, height); });
  return gap;
}

double time_to_land(const LocalPair& local, const Island& island, const Vector3d& gravity,
                    double longest) {
  const BodyState& box = island.bodies[static_cast<std::size_t>(local.a)];
  const BodyState& plane = island.bodies[static_cast<std::size_t>(local.b)];
  const Vector3d up = plane.rotation.col(2);
  const double acceleration = turning_acceleration(box) + box.other_acceleration - up.dot(gravity);
  double time = longest;
  visit_corners(box, plane, [&](double height, const Vector3d& arm) {
    const double closing = -up.dot(box.velocity + box.spin.cross(arm));
    time = close_within(time, height, {closing, acceleration});
  });
  return time;
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
