// SPDX-License-Identifier: MIT
// Triangles ready to draw: vertices with normals, smooth or flat as the shape itself says.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "render/visual_scene.h"

namespace verisim::render {

struct Vertex {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;  // unit
};

struct VertexMesh {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;  // three per triangle
};

/// The mesh moved by its offset. Two triangles at a shared corner share their normal there when
/// they meet at less than 55 degrees, which keeps the edges of a box sharp and a sphere round.
VertexMesh with_normals(const TriangleMesh& mesh, const Eigen::Vector3d& offset);

/// Unit sphere of 20 frequency^2 triangles on an icosahedron. Its corners lie a little outside of
/// the sphere, so that the outline is right on average.
VertexMesh geodesic_sphere(int frequency);

}  // namespace verisim::render
