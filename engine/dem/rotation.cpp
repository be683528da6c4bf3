// SPDX-License-Identifier: MIT
// How an orientation turns while the angular momentum stays what it is.
#include "dem/rotation.h"

#include <cmath>

#include "dem/bodies.h"

namespace verisim::dem {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& r) {
  Eigen::Matrix3d m;
  m << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  return m;
}

Eigen::Quaterniond rotation_of(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  // sin(angle/2)/angle; the series is exact to rounding below 1e-4 rad (next term angle^4/3840).
  const double factor =
      angle > 1e-4 ? std::sin(0.5 * angle) / angle : 0.5 - angle * angle * (1.0 / 48);
  const Eigen::Vector3d v = factor * rotation_vector;
  return {std::cos(0.5 * angle), v.x(), v.y(), v.z()};
}

Eigen::Quaterniond turn_by_euler(const Eigen::Quaterniond& q_wb,
                                 const Eigen::Vector3d& angular_velocity, double dt) {
  // (0, u) (w, v) = (-u . v, w u + u x v), written out: it runs for every body and step.
  const Eigen::Vector3d u = 0.5 * dt * angular_velocity;
  const double qw = q_wb.w(), qx = q_wb.x(), qy = q_wb.y(), qz = q_wb.z();
  const double w = qw - (u.x() * qx + u.y() * qy + u.z() * qz);
  const double x = qx + (qw * u.x() + u.y() * qz - u.z() * qy);
  const double y = qy + (qw * u.y() + u.z() * qx - u.x() * qz);
  const double z = qz + (qw * u.z() + u.x() * qy - u.y() * qx);
  const double scale = 1 / std::sqrt(w * w + x * x + y * y + z * z);
  return {scale * w, scale * x, scale * y, scale * z};
}

Eigen::Quaterniond turn_by_rkmk4(const Eigen::Quaterniond& q_wb,
                                 const Eigen::Matrix3d& inverse_inertia_b,
                                 const Eigen::Vector3d& angular_momentum, double dt) {
  // Rotation vectors k1..k4 are those of the world frame; [a, b] of two of them is a x b.
  const auto rate = [&](const Eigen::Quaterniond& q) -> Eigen::Vector3d {
    return dt * angular_velocity_of(inverse_inertia_b, q, angular_momentum);
  };
  const Eigen::Vector3d k1 = rate(q_wb);
  const Eigen::Vector3d k2 = rate(rotation_of(0.5 * k1) * q_wb);
  const Eigen::Vector3d k3 = rate(rotation_of(0.5 * k2 - 0.125 * k1.cross(k2)) * q_wb);
  const Eigen::Vector3d k4 = rate(rotation_of(k3) * q_wb);
  const Eigen::Vector3d turn = (k1 + 2 * k2 + 2 * k3 + k4 - 0.5 * k1.cross(k4)) / 6;
  return (rotation_of(turn) * q_wb).normalized();
}

}  // namespace verisim::dem
