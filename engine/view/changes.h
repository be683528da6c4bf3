// SPDX-License-Identifier: MIT
// What was changed by hand, as the overrides that repeat it.
#pragma once

#include <string>
#include <vector>

namespace verisim::view {

/// Overrides by path, in order of first change; a later value of a path replaces the earlier.
class Changes {
 public:
  Changes() = default;
  explicit Changes(const std::vector<std::string>& overrides);

  void set(const std::string& path, const std::string& value);
  bool empty() const { return entries_.empty(); }
  /// "path=value" each, as load_scene takes them.
  const std::vector<std::string>& overrides() const { return entries_; }
  /// `--set path=value --set ...`, quoted for a shell where it must be.
  std::string command_line() const;
  /// The same, one `--set` per line, for the eye.
  std::string lines() const;

 private:
  std::string joined_by(const char* between) const;

  std::vector<std::string> entries_;
};

/// Four significant digits, the shortest way to write them: 0.00025, 2e-05, 12000.
std::string number_text(double value);

}  // namespace verisim::view
