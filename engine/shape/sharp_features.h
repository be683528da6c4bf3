// SPDX-License-Identifier: MIT
// Edges and corners of a mesh: which triangles meet there, how sharply, and which stick out.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "shape/mesh.h"

namespace verisim::shape {

/// Between the normals of two triangles: 20 degrees. Finer facets count as a curved surface, which
/// has no edges.
constexpr double kSharpAngle = 0.3490658503988659;  // rad
/// Of what is missing to a full turn round a vertex that sticks out: 3 degrees. A blunter one
/// rises by less than 1/15 of the way to its neighbours.
constexpr double kLeastDeficit = 0.0523598775598299;  // rad

struct FaceShape {
  Eigen::Vector3d normal;  // unit, outward; zero for a triangle without area
  double area;             // m^2
};

struct MeshEdge {
  std::array<int, 2> vertices;
  std::array<int, 2> triangles;  // second is -1 at the border of an open mesh
  double angle;                  // rad, between the normals: 0 where flat
  bool is_convex;

  bool is_sharp() const { return angle > kSharpAngle; }
};

struct SharpVertex {
  int vertex;
  double deficit;               // rad, > kLeastDeficit: 2 pi less the angles round the vertex
  double longest_edge;          // m, of those that meet here
  Eigen::Vector3d mean_normal;  // unit, weighted by the angles
};

std::vector<FaceShape> face_shapes(const Mesh& mesh);

/// Every edge once, in the order in which the triangles name them first. Cost: linear.
std::vector<MeshEdge> mesh_edges(const Mesh& mesh, const std::vector<FaceShape>& faces);

/// Vertices where the surface is a peak (not a pit) sharper than kLeastDeficit. Angles and
/// directions are integrals round the vertex, so triangles may be split without effect.
std::vector<SharpVertex> sharp_convex_vertices(const Mesh& mesh,
                                               const std::vector<FaceShape>& faces);

}  // namespace verisim::shape
