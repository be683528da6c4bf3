// SPDX-License-Identifier: MIT
// The one exception of the renderer; its text is written for the person at the keyboard.
#pragma once

#include <stdexcept>

namespace verisim::render {

struct RenderError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace verisim::render
