// SPDX-License-Identifier: MIT
// Where the sun's shadow map looks, and which part of the ground can be in shadow.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/view.h"
#include "render/visual_scene.h"

namespace verisim::render {

constexpr int kMaxShadowMapSize = 2048;  // texels each way

struct BoundingSphere {
  glm::vec3 center;
  float radius;
};

/// A box along the sun's rays. Sun space: x, y and z in 0..1, z away from the sun.
struct Light {
  glm::mat4 world_to_sun{1};
  float texel = 0;            // m
  int width = 1, height = 1;  // texels
};

/// The smallest such box, on a grid of sizes and places that keeps texels fixed to the world, that
/// holds these spheres and the ground below them. Leaves out spheres that neither the camera
/// sees nor casts a shadow into its sight.
Light fit_light(const VisualScene& scene, const View& view,
                std::span<const BoundingSphere> spheres);

/// An oriented box that casts a shadow.
struct CasterBox {
  glm::mat4 body_to_world;
  glm::vec3 low, high;  // body axes
};

/// The eight corners of a box, in the world.
std::array<glm::vec3, 8> world_corners(const CasterBox& box);

/// Where on the ground the shadow of a box with these corners can fall: a convex outline, with a
/// margin (m) for the blur of its edge.
std::vector<glm::vec3> shadow_outline(const Ground& ground, const Sun& sun,
                                      std::span<const glm::vec3> corners, float margin);

/// Two unit vectors that span the ground and, with its normal, are right-handed.
std::pair<glm::vec3, glm::vec3> ground_axes(const Ground& ground);

}  // namespace verisim::render
