// SPDX-License-Identifier: MIT
#include "view/camera_control.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace verisim::view {
namespace {

constexpr double kTurnPerPixel = 0.006;  // rad
constexpr double kFlySpeed = 0.5;        // target distances per second
constexpr double kNotch = 0.9;           // distance kept per notch of the wheel
constexpr double kSteepest = 89 * std::numbers::pi / 180;
constexpr double kNearest = 1e-3, kFarthest = 1e4;  // m

Eigen::Vector3d back_of(const CameraControl& control) {
  const double level = std::cos(control.elevation);
  return {level * std::cos(control.azimuth), level * std::sin(control.azimuth),
          std::sin(control.elevation)};
}

Eigen::Vector3d eye_of(const CameraControl& control) {
  return control.target + control.distance * back_of(control);
}

Eigen::Vector3d right_of(const CameraControl& control) {
  return {-std::sin(control.azimuth), std::cos(control.azimuth), 0};
}

void turn(CameraControl& control, double right_px, double down_px) {
  control.azimuth =
      std::remainder(control.azimuth - kTurnPerPixel * right_px, 2 * std::numbers::pi);
  control.elevation =
      std::clamp(control.elevation + kTurnPerPixel * down_px, -kSteepest, kSteepest);
}

}  // namespace

CameraControl control_of(const render::Camera& camera) {
  CameraControl control;
  const Eigen::Vector3d back = camera.position - camera.look_at;
  control.target = camera.look_at;
  control.distance = std::clamp(back.norm(), kNearest, kFarthest);
  control.azimuth = std::atan2(back.y(), back.x());
  control.elevation =
      std::clamp(std::atan2(back.z(), std::hypot(back.x(), back.y())), -kSteepest, kSteepest);
  control.fov_deg = camera.fov_deg;
  return control;
}

render::Camera camera_of(const CameraControl& control) {
  return {eye_of(control), control.target, control.fov_deg};
}

void orbit(CameraControl& control, double right_px, double down_px) {
  turn(control, right_px, down_px);
}

void pan(CameraControl& control, double right_px, double down_px, int height_px) {
  const double half_angle = control.fov_deg / 2 * std::numbers::pi / 180;
  const double metres_per_pixel = 2 * control.distance * std::tan(half_angle) / height_px;
  const Eigen::Vector3d right = right_of(control);
  const Eigen::Vector3d up = back_of(control).cross(right);
  control.target += metres_per_pixel * (down_px * up - right_px * right);
}

void zoom(CameraControl& control, double notches) {
  control.distance = std::clamp(control.distance * std::pow(kNotch, notches), kNearest, kFarthest);
}

void look_around(CameraControl& control, double right_px, double down_px) {
  const Eigen::Vector3d eye = eye_of(control);
  turn(control, right_px, down_px);
  control.target = eye - control.distance * back_of(control);
}

void fly(CameraControl& control, const Eigen::Vector3d& heading, double seconds) {
  const double way = kFlySpeed * control.distance * seconds;
  control.target += way * (heading.x() * right_of(control) - heading.y() * back_of(control) +
                           heading.z() * Eigen::Vector3d::UnitZ());
}

}  // namespace verisim::view
