// SPDX-License-Identifier: MIT
// A short scene in motion, for the clip tests.
#pragma once

#include <cmath>

#include "dem/pose_log.h"
#include "render/visual_scene.h"

namespace verisim::clip {

struct ShortClip {
  render::VisualScene scene;
  dem::PoseLog log;
};

/// A ball that flies and turns over a box, 60 frames a second.
inline ShortClip short_clip(int num_frames) {
  ShortClip clip;
  clip.scene.camera = {{0.9, -1.3, 0.7}, {0, 0, 0.15}, 40};
  clip.scene.sun = render::sun_behind_camera(clip.scene.camera);
  render::VisualBody box, ball;
  box.name = "box";
  box.mesh = render::box_mesh({0.2, 0.2, 0.2});
  box.pattern = render::box_pattern({0.2, 0.2, 0.2});
  box.colour = render::palette_colour(0);
  ball.name = "ball";
  ball.spheres = {{Eigen::Vector3d::Zero(), 0.08}};
  ball.pattern = render::sphere_pattern(0.08);
  ball.colour = render::palette_colour(1);
  clip.scene.bodies = {box, ball};
  clip.log.names = {"box", "ball"};
  for (int i = 0; i < num_frames; ++i) {
    const double time = i / 60.0;
    dem::Pose resting, flying;
    resting.position = {0, 0, 0.1};
    flying.position = {-0.5 + 1.5 * time, 0.1, 0.3 + time - 4.905 * time * time};
    flying.orientation = Eigen::AngleAxisd(6 * time, Eigen::Vector3d::UnitY());
    clip.log.times.push_back(time);
    clip.log.poses.push_back(resting);
    clip.log.poses.push_back(flying);
  }
  return clip;
}

}  // namespace verisim::clip
