// SPDX-License-Identifier: MIT
// What the mouse and the keys do to the camera, the bodies and the controls.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "view/camera_control.h"
#include "view/grip.h"
#include "view/panels.h"
#include "view/window.h"

namespace verisim::view {

/// The part of the window that the picture fills, from its top left corner, in pixels.
struct Picture {
  int width = 0, height = 0;
  double pixels_per_unit = 1;
};

class Mouse {
 public:
  /// Moves the camera, grips and drags bodies (if `live`), from this frame's events.
  void handle(const Picture& picture, CameraControl& camera, LiveScene* live);
  /// Draws the spring between the grip and the mouse.
  void draw_grip(const Picture& picture, const CameraControl& camera, const LiveScene& live) const;
  /// Lets go: the bodies are about to be replaced.
  void release() { drag_.reset(); }

 private:
  void begin_drag(const Picture& picture, const CameraControl& camera, LiveScene& live);

  std::optional<dem::Drag> drag_;
  bool is_holding_ = false;    // the world has a drag
  int generation_ = -1;        // of the scene that the radii belong to
  std::vector<double> radii_;  // m, bounding spheres
};

/// Keys that change the controls or step a pose log.
void handle_keys(const std::vector<KeyPress>& keys, Controls& controls, PosePlayer* player);

}  // namespace verisim::view
