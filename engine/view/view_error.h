// SPDX-License-Identifier: MIT
// Why there is no window; the text is written for the person at the keyboard.
#pragma once

#include "render/render_error.h"

namespace verisim::view {

struct ViewError : render::RenderError {
  using RenderError::RenderError;
};

}  // namespace verisim::view
