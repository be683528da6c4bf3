// SPDX-License-Identifier: MIT
// Closed triangle meshes of boxes and balls, for drawing and for tests.
#pragma once

#include <Eigen/Core>

#include "shape/mesh.h"

namespace verisim::shape {

/// Box with full edge lengths `edges` (m, > 0), centred on the origin: 8 vertices, 12 triangles.
Mesh box_mesh(const Eigen::Vector3d& edges);

/// Icosahedron split `subdivisions` times (0 to 8), vertices on the sphere of `radius` (m):
/// 20 * 4^subdivisions triangles. Falls short of the ball's volume by about 0.55 / 4^subdivisions.
Mesh sphere_mesh(double radius, int subdivisions);

}  // namespace verisim::shape
