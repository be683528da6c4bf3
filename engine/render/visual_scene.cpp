// SPDX-License-Identifier: MIT
// Defaults of a scene's look: sun, palette, patterns, the box mesh.
#include "render/visual_scene.h"

#include <algorithm>
#include <cmath>

namespace verisim::render {

Sun sun_behind_camera(const Camera& camera) {
  constexpr double kAzimuth = 0.75;    // rad, left of the line from the scene to the camera
  constexpr double kElevation = 0.92;  // rad above the horizon
  const Eigen::Vector3d back = camera.position - camera.look_at;
  const double azimuth = std::atan2(back.y(), back.x()) - kAzimuth;
  return {{std::cos(azimuth) * std::cos(kElevation), std::sin(azimuth) * std::cos(kElevation),
           std::sin(kElevation)}};
}

Colour palette_colour(std::size_t index) {
  // Hues of Okabe and Ito (2008), toned down so that no channel clips in full sun.
  static constexpr std::array<Colour, 7> kColours{{{0.85F, 0.42F, 0.20F},
                                                   {0.16F, 0.47F, 0.71F},
                                                   {0.88F, 0.70F, 0.25F},
                                                   {0.14F, 0.60F, 0.48F},
                                                   {0.75F, 0.50F, 0.66F},
                                                   {0.42F, 0.70F, 0.86F},
                                                   {0.60F, 0.28F, 0.24F}}};
  return kColours[index % kColours.size()];
}

Colour fixed_body_colour() { return {0.62F, 0.60F, 0.57F}; }

Pattern box_pattern(const Eigen::Vector3d& edges) {
  const double wanted = edges.maxCoeff() / 4;
  Pattern pattern;
  for (int axis = 0; axis < 3; ++axis) {
    pattern.cell[axis] = edges[axis] / std::max(1.0, std::round(edges[axis] / wanted));
  }
  pattern.origin = -edges / 2;
  return pattern;
}

Pattern sphere_pattern(double radius) {
  return {PatternKind::kChecker, Eigen::Vector3d::Constant(2 * radius), {0, 0, 0}};
}

Pattern mesh_pattern(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const double cell = (high - low).maxCoeff() / 6;
  return {PatternKind::kChecker, Eigen::Vector3d::Constant(cell), (low + high) / 2};
}

TriangleMesh box_mesh(const Eigen::Vector3d& edges) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.emplace_back((corner & 1 ? 0.5 : -0.5) * edges.x(),
                                (corner & 2 ? 0.5 : -0.5) * edges.y(),
                                (corner & 4 ? 0.5 : -0.5) * edges.z());
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

}  // namespace verisim::render
