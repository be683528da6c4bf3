// SPDX-License-Identifier: MIT
// Camera mathematics.
#include "render/view.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "render/glm_eigen.h"
#include "render/render_error.h"

namespace verisim::render {

View make_view(const Camera& camera, int width, int height) {
  const Eigen::Vector3d forward_d = camera.look_at - camera.position;
  const double distance = forward_d.norm();
  if (!(distance > 0) || !(camera.fov_deg > 0 && camera.fov_deg < 180)) {
    throw RenderError(
        "camera: position and look_at must differ, and fov_deg lie between 0 and 180");
  }
  const glm::vec3 forward = to_glm(forward_d / distance);
  // Looking straight down has no upright; north is up then, as on a map.
  const bool is_vertical = std::abs(forward.z) > 0.9999F;
  const glm::vec3 upright = is_vertical ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1);
  const glm::vec3 right = glm::normalize(glm::cross(forward, upright));
  const glm::vec3 up = glm::cross(right, forward);

  View view;
  view.eye = to_glm(camera.position);
  const float half_angle = glm::radians(static_cast<float>(camera.fov_deg)) / 2;
  const float tangent_y = std::tan(half_angle);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  const float tangent_x = tangent_y * aspect;
  const float depth_scale = static_cast<float>(distance);
  view.world_to_clip =
      glm::perspective(2 * half_angle, aspect, 0.02F * depth_scale, 200 * depth_scale) *
      glm::lookAt(view.eye, view.eye + forward, upright);
  const float pixel = 2 * tangent_y / static_cast<float>(height);
  view.pixel_to_ray = {right * pixel, up * pixel, forward - right * tangent_x - up * tangent_y};
  view.width = width;
  view.height = height;
  view.pixels_per_radian = 1 / pixel;

  const std::array<glm::vec3, 4> normals{
      glm::normalize(forward * tangent_x + right), glm::normalize(forward * tangent_x - right),
      glm::normalize(forward * tangent_y + up), glm::normalize(forward * tangent_y - up)};
  for (std::size_t i = 0; i < normals.size(); ++i) {
    view.side_planes[i] = glm::vec4(normals[i], glm::dot(normals[i], view.eye));
  }
  return view;
}

PixelRect unite(const PixelRect& a, const PixelRect& b) {
  if (a.left >= a.right) return b;
  if (b.left >= b.right) return a;
  return {std::min(a.left, b.left), std::min(a.bottom, b.bottom), std::max(a.right, b.right),
          std::max(a.top, b.top)};
}

std::optional<std::vector<glm::vec2>> to_pixels(const View& view,
                                                std::span<const glm::vec3> points) {
  std::vector<glm::vec2> pixels;
  for (const glm::vec3& point : points) {
    const glm::vec4 clip = view.world_to_clip * glm::vec4(point, 1);
    if (clip.w <= 0) return std::nullopt;
    pixels.push_back((glm::vec2(clip) / clip.w * 0.5F + 0.5F) * glm::vec2(view.width, view.height));
  }
  return pixels;
}

PixelRect touched_pixels(const View& view, std::span<const glm::vec2> points) {
  constexpr float kMargin = 2;  // px, more than rounding and antialiasing reach
  const glm::vec2 size(view.width, view.height);
  glm::vec2 low = size, high(0);
  for (const glm::vec2& point : points) {
    low = glm::min(low, point - kMargin);
    high = glm::max(high, point + kMargin);
  }
  low = glm::clamp(low, glm::vec2(0), size);
  high = glm::clamp(high, glm::vec2(0), size);
  return {static_cast<int>(std::floor(low.x)), static_cast<int>(std::floor(low.y)),
          static_cast<int>(std::ceil(high.x)), static_cast<int>(std::ceil(high.y))};
}

bool is_in_sight(const View& view, const glm::vec3& center, float radius) {
  for (const glm::vec4& plane : view.side_planes) {
    if (glm::dot(glm::vec3(plane), center) - plane.w < -radius) return false;
  }
  return true;
}

}  // namespace verisim::render
