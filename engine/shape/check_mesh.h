// SPDX-License-Identifier: MIT
// Finds what keeps a triangle mesh from being the surface of a solid.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "shape/mesh.h"
#include "shape/mesh_error.h"

namespace verisim::shape {

struct MeshProblem {
  std::string code;       // see check_mesh
  long count;             // how many vertices, triangles or edges have it
  Eigen::Vector3d place;  // m, mesh frame: where the first one is
  std::string message;    // one line for people, with count, place and what to do
};

/// All problems of the mesh, most basic first; empty for the closed surface of a solid. Codes:
///   no_triangles         nothing to check
///   bad_index            triangle names a vertex that does not exist (nothing else is checked)
///   nonfinite            vertex with NaN or infinity (nothing else is checked)
///   degenerate_triangle  triangle with the same vertex twice
///   open_edge            edge of one triangle only
///   overused_edge        edge of more than two triangles
///   mismatched_winding   edge that its two triangles run through in the same direction
///   flat                 thinner than a millionth of its size, the precision of loaded files
///   inside_out           volume below zero: normals point inwards (closed meshes only)
/// Self-intersection is not looked for here; `fill_mesh` counts cells that are inside twice.
/// Cost: n log n in triangles.
std::vector<MeshProblem> check_mesh(const Mesh& mesh);

/// Throws MeshError naming `file` and every problem that check_mesh finds, with count and place.
void require_solid(const Mesh& mesh, const std::string& file);

}  // namespace verisim::shape
