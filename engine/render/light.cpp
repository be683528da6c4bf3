// SPDX-License-Identifier: MIT
// Fits the shadow map to the scene and finds the ground that can be in shadow.
#include "render/light.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/glm_eigen.h"

namespace verisim::render {
namespace {

constexpr float kPixelsPerTexel = 0.8F;  // of the picture; more shows stairs in shadow edges

/// How far along the sun's ray, away from the sun, the ground lies; negative = towards it.
float distance_to_ground(const Ground& ground, const Sun& sun, const glm::vec3& point) {
  const glm::vec3 normal = to_glm(ground.normal);
  const float height = glm::dot(normal, point) - static_cast<float>(ground.offset);
  return height / std::max(glm::dot(normal, to_glm(sun.direction)), 1e-3F);
}

bool matters(const VisualScene& scene, const View& view, const BoundingSphere& sphere) {
  // One sphere around body and shadow: never leaves out what is seen, may keep a little more.
  float reach = 0;
  if (scene.ground.present) {
    reach = std::max(0.0F, distance_to_ground(scene.ground, scene.sun, sphere.center));
  }
  const glm::vec3 middle = sphere.center - to_glm(scene.sun.direction) * (reach / 2);
  return is_in_sight(view, middle, sphere.radius + reach / 2);
}

/// The next of the sizes 2^(k/4) m, so that a moving fit changes size seldom.
float quantised_size(float size) {
  return std::exp2(std::ceil(std::log2(std::max(size, 1e-6F)) * 4) / 4);
}

float cross_2d(const glm::vec2& o, const glm::vec2& a, const glm::vec2& b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

/// Convex hull, counter-clockwise (Andrew 1979, monotone chain).
std::vector<glm::vec2> convex_hull(std::vector<glm::vec2> points) {
  std::sort(points.begin(), points.end(), [](const glm::vec2& a, const glm::vec2& b) {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
  });
  std::vector<glm::vec2> hull;
  const auto extend = [&hull](const glm::vec2& point, std::size_t keep) {
    while (hull.size() >= keep + 2 && cross_2d(hull[hull.size() - 2], hull.back(), point) <= 0) {
      hull.pop_back();
    }
    hull.push_back(point);
  };
  for (const glm::vec2& point : points) extend(point, 0);
  const std::size_t lower = hull.size() - 1;
  for (auto point = points.rbegin() + 1; point != points.rend(); ++point) extend(*point, lower);
  hull.pop_back();
  return hull;
}

}  // namespace

std::pair<glm::vec3, glm::vec3> ground_axes(const Ground& ground) {
  const glm::vec3 normal = to_glm(ground.normal);
  const glm::vec3 along =
      std::abs(normal.x) > 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);  // any but the normal
  const glm::vec3 first = glm::normalize(along - normal * glm::dot(normal, along));
  return {first, glm::cross(normal, first)};
}

Light fit_light(const VisualScene& scene, const View& view,
                std::span<const BoundingSphere> spheres) {
  const glm::vec3 to_sun = to_glm(scene.sun.direction);
  const glm::vec3 helper = std::abs(to_sun.z) > 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1);
  const glm::vec3 right = glm::normalize(glm::cross(helper, to_sun));
  const glm::vec3 up = glm::cross(to_sun, right);
  const glm::mat3 world_to_axes = glm::transpose(glm::mat3(right, up, -to_sun));

  Light light;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  glm::vec3 low(kInfinity), high(-kInfinity);
  float nearest = kInfinity;
  for (const BoundingSphere& sphere : spheres) {
    if (!matters(scene, view, sphere)) continue;
    const glm::vec3 center = world_to_axes * sphere.center;
    low = glm::min(low, center - sphere.radius);
    high = glm::max(high, center + sphere.radius);
    nearest = std::min(nearest, glm::length(sphere.center - view.eye));
  }
  if (low.x > high.x) low = high = glm::vec3(0);
  if (nearest == kInfinity) nearest = 1;

  // No finer than the picture shows it where it is nearest, no coarser than fits the map.
  const glm::vec2 extent = glm::vec2(high - low);
  const float pixel = std::max(nearest, 1e-3F) / view.pixels_per_radian;
  constexpr int kMargin = 4;  // texels without casters around the rest
  light.texel = quantised_size(std::max(
      pixel * kPixelsPerTexel, std::max(extent.x, extent.y) / (kMaxShadowMapSize - 2 * kMargin)));
  const glm::vec2 corner =
      (glm::floor(glm::vec2(low) / light.texel) - 1.0F * kMargin) * light.texel;
  const glm::ivec2 texels = glm::ivec2(glm::ceil(extent / light.texel)) + 2 * kMargin + 1;
  constexpr int kBlock = 64;  // a moving fit changes size seldom
  light.width = std::min((texels.x + kBlock - 1) / kBlock * kBlock, kMaxShadowMapSize);
  light.height = std::min((texels.y + kBlock - 1) / kBlock * kBlock, kMaxShadowMapSize);
  const glm::vec2 size = glm::vec2(light.width, light.height) * light.texel;
  if (scene.ground.present) {
    for (int i = 0; i < 4; ++i) {
      const glm::vec3 above(corner.x + (i & 1 ? size.x : 0), corner.y + (i & 2 ? size.y : 0),
                            low.z);
      const float reach =
          distance_to_ground(scene.ground, scene.sun, glm::transpose(world_to_axes) * above);
      high.z = std::max(high.z, low.z + reach);
    }
  }
  const float depth = std::max(high.z - low.z, 1e-3F) * 1.02F;
  const glm::vec3 scale(1 / size.x, 1 / size.y, 1 / depth);
  const glm::vec3 origin(corner.x, corner.y, low.z - 0.01F * depth);
  for (int column = 0; column < 3; ++column) {
    light.world_to_sun[column] = glm::vec4(world_to_axes[column] * scale, 0);
  }
  light.world_to_sun[3] = glm::vec4(-origin * scale, 1);
  return light;
}

std::array<glm::vec3, 8> world_corners(const CasterBox& box) {
  std::array<glm::vec3, 8> corners;
  for (int i = 0; i < 8; ++i) {
    corners[i] = box.body_to_world * glm::vec4(i & 1 ? box.high.x : box.low.x,
                                               i & 2 ? box.high.y : box.low.y,
                                               i & 4 ? box.high.z : box.low.z, 1);
  }
  return corners;
}

std::vector<glm::vec3> shadow_outline(const Ground& ground, const Sun& sun,
                                      std::span<const glm::vec3> corners, float margin) {
  const auto [first, second] = ground_axes(ground);
  const glm::vec3 to_sun = to_glm(sun.direction);
  std::vector<glm::vec2> points;
  for (const glm::vec3& corner : corners) {
    const glm::vec3 shadow = corner - to_sun * distance_to_ground(ground, sun, corner);
    for (int i = 0; i < 4; ++i) {
      points.emplace_back(glm::dot(shadow, first) + (i & 1 ? margin : -margin),
                          glm::dot(shadow, second) + (i & 2 ? margin : -margin));
    }
  }
  std::vector<glm::vec3> outline;
  const glm::vec3 base = to_glm(ground.normal * ground.offset);
  for (const glm::vec2& p : convex_hull(std::move(points))) {
    outline.push_back(base + first * p.x + second * p.y);
  }
  return outline;
}

}  // namespace verisim::render
