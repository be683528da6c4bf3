// SPDX-License-Identifier: MIT
#include "view/grip.h"

#include <numbers>

namespace verisim::view {

dem::Drag grip_body(const Pick& pick, const dem::Pose& pose, double mass) {
  constexpr double kFrequency = 3;  // Hz; lower lags, higher jerks
  constexpr double kDampingRatio = 0.7;
  const double omega = 2 * std::numbers::pi * kFrequency;
  dem::Drag drag;
  drag.body = pick.body;
  drag.grip_b = pose.orientation.conjugate() * (pick.point - pose.position);
  drag.target = pick.point;
  drag.stiffness = mass * omega * omega;
  drag.damping = 2 * kDampingRatio * mass * omega;
  return drag;
}

Eigen::Vector3d follow_mouse(const Ray& ray, const render::Camera& camera,
                             const Eigen::Vector3d& point) {
  const Eigen::Vector3d forward = (camera.look_at - camera.position).normalized();
  const double facing = ray.direction.dot(forward);
  if (facing < 1e-6) return point;
  return ray.origin + ray.direction * ((point - ray.origin).dot(forward) / facing);
}

Eigen::Vector3d grip_point(const dem::Drag& drag, const dem::Pose& pose) {
  return pose.position + pose.orientation * drag.grip_b;
}

}  // namespace verisim::view
