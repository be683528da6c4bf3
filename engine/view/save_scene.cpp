// SPDX-License-Identifier: MIT
#include "view/save_scene.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "scene/load_scene.h"
#include "view/view_error.h"

namespace verisim::view {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& cause) {
  throw ViewError(file.string() + " cannot be written: " + cause +
                  "\nhint: copy the --set line instead, or make room in that folder");
}

// Creates an empty file of a free name, so that nobody else takes it.
fs::path reserve_name(const fs::path& scene) {
  for (int i = 1;; ++i) {
    const std::string number = i == 1 ? "" : "_" + std::to_string(i);
    const fs::path file =
        scene.parent_path() / (scene.stem().string() + "_changed" + number + ".yaml");
    std::FILE* created = std::fopen(file.c_str(), "wx");  // x: fails if it exists
    if (created != nullptr) {
      std::fclose(created);
      return file;
    }
    if (errno != EEXIST) refuse(file, std::strerror(errno));
  }
}

}  // namespace

fs::path save_scene(const fs::path& scene, const std::vector<std::string>& overrides) {
  const std::string text = scene::load_scene(scene, overrides).resolved_yaml;
  const fs::path file = reserve_name(scene);
  const fs::path temporary =
      file.parent_path() / ("." + file.filename().string() + "." + std::to_string(getpid()));
  std::error_code error;
  std::ofstream stream(temporary, std::ios::binary);
  stream << text;
  stream.close();
  std::string cause = stream ? "" : std::strerror(errno);
  if (cause.empty()) {
    fs::rename(temporary, file, error);
    if (error) cause = error.message();
  }
  if (!cause.empty()) {
    fs::remove(temporary, error);
    fs::remove(file, error);
    refuse(file, cause);
  }
  return file;
}

}  // namespace verisim::view
