// SPDX-License-Identifier: MIT
// Moves a camera by hand: orbit, pan, zoom, look around, fly. Pure numbers, no window.
#pragma once

#include <Eigen/Core>

#include "render/visual_scene.h"

namespace verisim::view {

/// A camera as a point it turns about and where it stands from there.
struct CameraControl {
  Eigen::Vector3d target{0, 0, 0};  // m
  double distance = 1;              // m, from the target to the eye
  double azimuth = 0;               // rad about z, from x, of the eye seen from the target
  double elevation = 0;             // rad above the horizon, within 89 degrees
  double fov_deg = 40;              // vertical
};

CameraControl control_of(const render::Camera& camera);
render::Camera camera_of(const CameraControl& control);

/// Turns about the target as if the mouse held the scene: `right_px`, `down_px` of mouse motion.
void orbit(CameraControl& control, double right_px, double down_px);

/// Moves sideways, so that what lies at the target's depth follows the mouse.
void pan(CameraControl& control, double right_px, double down_px, int height_px);

/// Nears the target by a tenth per notch of the wheel; negative notches leave it.
void zoom(CameraControl& control, double notches);

/// Turns the head: the eye stays where it is.
void look_around(CameraControl& control, double right_px, double down_px);

/// Flies for `seconds` at half the target distance per second along `heading` (right, forward, up).
void fly(CameraControl& control, const Eigen::Vector3d& heading, double seconds);

}  // namespace verisim::view
