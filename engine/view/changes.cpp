// SPDX-License-Identifier: MIT
#include "view/changes.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>

namespace verisim::view {
namespace {

std::string path_of(const std::string& entry) { return entry.substr(0, entry.find('=')); }

std::string quoted_for_shell(const std::string& text) {
  constexpr const char* kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_=.,:/+-";
  if (text.find_first_not_of(kPlain) == std::string::npos) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

Changes::Changes(const std::vector<std::string>& overrides) {
  for (const std::string& entry : overrides) {
    const std::string path = path_of(entry);
    set(path, entry.substr(std::min(entry.size(), path.size() + 1)));
  }
}

void Changes::set(const std::string& path, const std::string& value) {
  const std::string entry = path + "=" + value;
  const auto old = std::find_if(entries_.begin(), entries_.end(),
                                [&](const std::string& e) { return path_of(e) == path; });
  if (old == entries_.end()) {
    entries_.push_back(entry);
  } else {
    *old = entry;
  }
}

std::string Changes::joined_by(const char* between) const {
  std::string text;
  for (const std::string& entry : entries_) {
    if (!text.empty()) text += between;
    text += "--set " + quoted_for_shell(entry);
  }
  return text;
}

std::string Changes::command_line() const { return joined_by(" "); }

std::string Changes::lines() const { return joined_by("\n"); }

std::string number_text(double value) {
  char rounded[32];
  std::snprintf(rounded, sizeof rounded, "%.4g", value);
  char shortest[32];
  const double kept = std::strtod(rounded, nullptr) + 0.0;  // + 0.0: no minus zero
  const auto end = std::to_chars(shortest, shortest + sizeof shortest, kept).ptr;
  return {shortest, end};
}

}  // namespace verisim::view
