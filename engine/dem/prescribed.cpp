// SPDX-License-Identifier: MIT
// Pose and velocity of a body that follows given poses.
#include "dem/prescribed.h"

#include <algorithm>

namespace verisim::dem {
namespace {

Pose at_rest(Pose pose) {
  pose.linear_velocity.setZero();
  pose.angular_velocity.setZero();
  return pose;
}

/// Cubic Hermite curve and slerp at the share s of an interval of length h (s).
Pose between(const Pose& a, const Pose& b, double h, double s) {
  const Eigen::Vector3d chord = b.position - a.position;
  const Eigen::Vector3d m0 = h * a.linear_velocity, m1 = h * b.linear_velocity;
  // p(s) = a + s m0 + s^2 (3 chord - 2 m0 - m1) + s^3 (m0 + m1 - 2 chord)
  const Eigen::Vector3d c2 = 3 * chord - 2 * m0 - m1, c3 = m0 + m1 - 2 * chord;
  Pose pose;
  pose.position = a.position + s * (m0 + s * (c2 + s * c3));
  pose.linear_velocity = (m0 + s * (2 * c2 + 3 * s * c3)) / h;

  const Eigen::Quaterniond qa = a.orientation.normalized(), qb = b.orientation.normalized();
  pose.orientation = qa.slerp(s, qb).normalized();
  // Slerp turns about one fixed axis at a constant rate, the short way round.
  const Eigen::AngleAxisd turn(qb * qa.conjugate());
  const bool is_long_way = turn.angle() > EIGEN_PI;
  const double angle = is_long_way ? turn.angle() - 2 * EIGEN_PI : turn.angle();
  pose.angular_velocity = turn.axis() * (angle / h);
  return pose;
}

}  // namespace

Pose pose_at(const PrescribedMotion& motion, double time) {
  const std::vector<double>& times = motion.times;
  if (time < times.front()) return at_rest(motion.poses.front());
  if (time >= times.back()) return at_rest(motion.poses.back());
  const auto after = std::upper_bound(times.begin(), times.end(), time) - times.begin();
  const auto b = static_cast<std::size_t>(after), a = b - 1;
  const double h = times[b] - times[a];
  return between(motion.poses[a], motion.poses[b], h, (time - times[a]) / h);
}

}  // namespace verisim::dem
