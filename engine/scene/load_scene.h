// SPDX-License-Identifier: MIT
// scene.yaml (+ overrides) -> Scene.
#pragma once

#include "scene/problem.h"
#include "scene/scene.h"

namespace verisim::scene {

/// Reads a scene strictly. overrides: "path=value", applied in order.
/// Throws SceneError with every problem of the file at once.
Scene load_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

}  // namespace verisim::scene
