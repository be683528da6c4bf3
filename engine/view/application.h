// SPDX-License-Identifier: MIT
// `verisim view`: a scene in a window, live or from a pose log.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "clip/visualise.h"
#include "dem/pose_log.h"
#include "scene/scene.h"

namespace verisim::view {

struct ViewOptions {
  std::vector<std::string> overrides;  // those that `scene` was loaded with
  std::optional<dem::PoseLog> poses;   // shown instead of a simulation; the scene's bodies
  clip::Show show = clip::Show::kMesh;
  std::filesystem::path screenshot;  // if named: write this PNG and close ...
  double after = 0;                  // s, ... at this time of the scene
};

/// Opens the window and returns when it is closed. each_frame may throw to close it.
/// Throws ViewError without a display, SceneError on a scene that cannot run.
void view(const scene::Scene& scene, const ViewOptions& options,
          const std::function<void()>& each_frame);

}  // namespace verisim::view
