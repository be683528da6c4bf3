// SPDX-License-Identifier: MIT
// Where a camera sees what: matrices, the ray of a pixel, and whether a sphere is in sight.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "render/visual_scene.h"

namespace verisim::render {

struct View {
  glm::vec3 eye;
  glm::mat4 world_to_clip;
  glm::mat3 pixel_to_ray;       // (x, y, 1) in pixels from the bottom left to a world direction
  int width = 0, height = 0;    // px
  float pixels_per_radian = 0;  // at the middle of the picture
  std::array<glm::vec4, 4> side_planes{};  // unit normals inwards, w = offset
};

/// Throws RenderError if the camera looks nowhere or has no angle.
View make_view(const Camera& camera, int width, int height);

/// Pixels from (left, bottom) up to but without (right, top).
struct PixelRect {
  int left = 0, bottom = 0, right = 0, top = 0;
};

/// The smallest rectangle that holds both; an empty one (left >= right) adds nothing.
PixelRect unite(const PixelRect& a, const PixelRect& b);

/// Where points appear, px from the bottom left; none if one is behind the camera.
std::optional<std::vector<glm::vec2>> to_pixels(const View& view,
                                                std::span<const glm::vec3> points);

/// Pixels that the hull of these points can touch.
PixelRect touched_pixels(const View& view, std::span<const glm::vec2> points);

/// True unless the sphere lies wholly outside of one side of the picture.
bool is_in_sight(const View& view, const glm::vec3& center, float radius);

}  // namespace verisim::render
