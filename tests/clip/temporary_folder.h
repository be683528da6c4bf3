// SPDX-License-Identifier: MIT
// A folder for one test, removed after it.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

namespace verisim::clip {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    // mkdtemp wants six of these at the end and puts letters of its own in their place.
    std::string pattern = (std::filesystem::temp_directory_path() / "verisim_clip_").string();
    pattern.append(6, 'X');
    path_ = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path operator/(const char* name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }
  bool is_empty() const { return std::filesystem::is_empty(path_); }

 private:
  std::filesystem::path path_;
};

}  // namespace verisim::clip
