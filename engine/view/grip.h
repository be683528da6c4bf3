// SPDX-License-Identifier: MIT
// A body held by the mouse: the spring that pulls it, and where it is pulled to.
#pragma once

#include "dem/world.h"
#include "view/picking.h"

namespace verisim::view {

/// A spring from the picked point, at rest where it is. Its strength follows the body's mass, so
/// that a feather and an anvil follow the hand alike: 3 Hz, 70 % of critical damping.
dem::Drag grip_body(const Pick& pick, const dem::Pose& pose, double mass);

/// Where the ray meets the plane through `point` that faces the camera; `point` itself if the ray
/// runs along that plane. Dragging a body keeps its distance to the camera by this.
Eigen::Vector3d follow_mouse(const Ray& ray, const render::Camera& camera,
                             const Eigen::Vector3d& point);

/// The grip point of a drag in the world, m.
Eigen::Vector3d grip_point(const dem::Drag& drag, const dem::Pose& pose);

}  // namespace verisim::view
