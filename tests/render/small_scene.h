// SPDX-License-Identifier: MIT
// A small scene and ways to draw it, for the renderer's tests.
#pragma once

#include <cstdint>
#include <vector>

#include "dem/pose_log.h"
#include "render/context.h"
#include "render/renderer.h"
#include "render/visual_scene.h"

namespace verisim::render {

using Pixels = std::vector<std::uint8_t>;  // RGBA, bottom row first

/// A look and one pose per body.
struct Still {
  VisualScene scene;
  std::vector<dem::Pose> poses;
  int width = 320, height = 180;

  void add(VisualBody body, const Eigen::Vector3d& position,
           const Eigen::Quaterniond& orientation = Eigen::Quaterniond::Identity()) {
    body.name = "body " + std::to_string(scene.bodies.size());
    body.colour = palette_colour(scene.bodies.size());
    scene.bodies.push_back(std::move(body));
    dem::Pose pose;
    pose.position = position;
    pose.orientation = orientation;
    poses.push_back(pose);
  }
  void add_box(const Eigen::Vector3d& edges, const Eigen::Vector3d& position) {
    VisualBody body;
    body.mesh = box_mesh(edges);
    body.pattern = box_pattern(edges);
    add(std::move(body), position);
  }
  void add_ball(double radius, const Eigen::Vector3d& position,
                const Eigen::Quaterniond& orientation = Eigen::Quaterniond::Identity()) {
    VisualBody body;
    body.spheres = {{Eigen::Vector3d::Zero(), radius}};
    body.pattern = sphere_pattern(radius);
    add(std::move(body), position, orientation);
  }
};

inline Still empty_still() {
  Still still;
  still.scene.camera = {{0.9, -1.3, 0.7}, {0, 0, 0.15}, 40};
  still.scene.sun = sun_behind_camera(still.scene.camera);
  return still;
}

/// A box at rest, a ball at rest and a ball in the air.
inline Still small_still() {
  Still still = empty_still();
  still.add_box({0.2, 0.2, 0.2}, {0, 0, 0.1});
  still.add_ball(0.1, {0.35, 0.1, 0.1});
  still.add_ball(0.06, {-0.3, 0, 0.35}, Eigen::Quaterniond(0.8, 0.2, 0.5, 0.1).normalized());
  return still;
}

inline Pixels picture_of(Renderer& renderer, const std::vector<dem::Pose>& poses) {
  Pixels pixels(4 * static_cast<std::size_t>(renderer.width()) * renderer.height());
  renderer.draw(poses);
  renderer.read_pixels(pixels);
  return pixels;
}

inline Pixels picture_of(const Context& context, const Still& still) {
  Renderer renderer(context.get_proc_address(), still.scene, still.width, still.height);
  renderer.fit_light(still.poses);
  return picture_of(renderer, still.poses);
}

inline Pixels picture_of(const Still& still) {
  return picture_of(*make_context(ContextKind::kAuto, 0), still);
}

}  // namespace verisim::render
