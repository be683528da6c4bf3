// SPDX-License-Identifier: MIT
// The one exception of clip making and reading; its text is written for the person at the keyboard.
#pragma once

#include <stdexcept>

namespace verisim::clip {

struct ClipError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace verisim::clip
