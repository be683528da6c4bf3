// SPDX-License-Identifier: MIT
// Writes a scene with changes as a new scene file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace verisim::view {

/// Reads `scene` with the overrides and writes the result beside it, where its relative paths
/// still hold: NAME_changed.yaml, or NAME_changed_2.yaml and so on if that exists. Returns the
/// new file. Nothing is overwritten; the file appears complete or not at all.
/// Throws SceneError if the overrides do not fit, ViewError if the folder cannot be written.
std::filesystem::path save_scene(const std::filesystem::path& scene,
                                 const std::vector<std::string>& overrides);

}  // namespace verisim::view
