// SPDX-License-Identifier: MIT
// A scene file as a YAML tree with overrides applied, and where each value came from.
#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <string>
#include <vector>

#include "scene/problem.h"

namespace verisim::scene {

struct Override {
  std::string path;  // e.g. bodies.fox.position_m
  std::string text;  // as written after '='
};

struct Document {
  std::filesystem::path file;
  YAML::Node root;
  std::vector<Override> overrides;

  /// "file:line", or "--set path=value" for what an override replaced.
  std::string where(const std::string& path, const YAML::Node& node) const;
};

/// Reads the file and applies `path=value` overrides in order. A list of named maps is entered by
/// name (bodies.fox.position_m) or by index (bodies.0.position_m); maps on the way are created.
/// Throws SceneError when the file cannot be read or parsed or an override has no place.
Document read_document(const std::filesystem::path& file,
                       const std::vector<std::string>& overrides);

/// A node as it would be written on one line, shortened for a message.
std::string one_line(const YAML::Node& node);

}  // namespace verisim::scene
