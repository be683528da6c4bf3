// SPDX-License-Identifier: MIT
// Which body lies under the mouse, and where the world lies on the screen.
// Pixels count from the top left of the picture, as the mouse does.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "dem/pose_log.h"
#include "render/visual_scene.h"
#include "shape/mesh.h"

namespace verisim::view {

struct Ray {
  Eigen::Vector3d origin, direction;  // m, unit
};

struct Pick {
  int body = -1;
  double distance = 0;    // m along the ray
  Eigen::Vector3d point;  // m, world
};

/// The ray through a point of the picture. Throws RenderError on a camera that looks nowhere.
Ray ray_of_pixel(const render::Camera& camera, int width, int height, const Eigen::Vector2d& pixel);

/// Where a point of the world is seen; none behind the eye.
std::optional<Eigen::Vector2d> pixel_of_point(const render::Camera& camera, int width, int height,
                                              const Eigen::Vector3d& point);

/// Farthest vertex from the body's origin, m.
double bounding_radius(const shape::Mesh& mesh);

/// Distance along the ray to the first triangle whose outside it meets; none if it misses.
/// The ray is in the mesh's frame.
std::optional<double> meet_mesh(const Ray& ray, const shape::Mesh& mesh);

/// The nearest body on the ray: bounding spheres first, then triangles. The three spans have one
/// entry per body; meshes are in body axes about the centre of mass.
/// Cost: the triangles of every body whose bounding sphere the ray meets.
std::optional<Pick> pick_body(const Ray& ray, std::span<const shape::Mesh> meshes,
                              std::span<const double> radii, std::span<const dem::Pose> poses);

}  // namespace verisim::view
