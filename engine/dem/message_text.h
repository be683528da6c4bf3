// SPDX-License-Identifier: MIT
// Words and numbers of a message, joined.
#pragma once

#include <sstream>
#include <string>

namespace verisim::dem {

/// Numbers with three digits.
template <class... Parts>
std::string text(const Parts&... parts) {
  std::ostringstream stream;
  stream.precision(3);
  (stream << ... << parts);
  return stream.str();
}

}  // namespace verisim::dem
