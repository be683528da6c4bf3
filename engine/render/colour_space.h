// SPDX-License-Identifier: MIT
// From sRGB-encoded colours to linear light.
#pragma once

#include <cmath>
#include <glm/glm.hpp>

#include "render/visual_scene.h"

namespace verisim::render {

inline float to_linear(float encoded) {  // IEC 61966-2-1
  return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

inline glm::vec3 to_linear(const Colour& colour) {
  return {to_linear(colour.red), to_linear(colour.green), to_linear(colour.blue)};
}

}  // namespace verisim::render
