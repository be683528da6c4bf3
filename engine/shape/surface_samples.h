// SPDX-License-Identifier: MIT
// Points on a mesh that stand for pieces of its faces, of its sharp edges, and for its corners.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "shape/mesh.h"
#include "shape/mesh_error.h"

namespace verisim::shape {

/// One of three kinds: a piece of a face (area > 0), of a convex edge (edge_length > 0), or a sharp
/// convex corner (is_vertex).
struct SurfaceSample {
  Eigen::Vector3d position;  // m, mesh frame, on the mesh
  Eigen::Vector3d normal;    // unit, outward, the mean over the piece
  double area;               // m^2, else 0
  double edge_length;        // m, else 0
  bool is_vertex;
  /// Of a piece of a flat face of at least (3 spacing)^2 with samples on all its convex edges: what
  /// touches it there alone has an edge, a corner or a curve of its own.
  bool is_framed = false;
};

/// More would take longer in every contact than any quadrature is worth.
constexpr double kMaxNumSurfaceSamples = 1e6;

/// Quadrature points of the surface, about `spacing` (m) apart. A lattice along the mesh's axes,
/// centred on the bounding box and dividing it evenly, cuts the surface: each triangle along the
/// two axes across its largest normal component, each edge along the axis of its largest
/// component. Connected pieces within a cell make one sample at their common centre, moved onto
/// the nearest of them. So areas sum to the mesh's area and lengths to the length of its sharp
/// convex edges (both to 1e-12), moments of plane faces up to the first are exact, mirror-symmetric
/// meshes have mirror-symmetric samples, and neither splitting flat triangles nor their order
/// matters. Edges are sharp beyond 20 degrees (sharp_features.h), or beyond 3 between flat faces of
/// at least (3 spacing)^2; where triangles are far smaller than the spacing, features closer than
/// the lattice count once (as far as neighbours face alike: a surface as rough as its triangles are
/// small gets up to a sample for each).
/// Edge and corner samples stand beside the faces', for contacts that faces alone would miss.
/// The mesh must pass check_mesh. Throws MeshError when spacing is not a positive number or would
/// need more than kMaxNumSurfaceSamples. Cost: (triangles + samples) x log.
/// Idea: contact forces as integrals over a triangulated surface, Smeets et al. 2014.
std::vector<SurfaceSample> sample_surface(const Mesh& mesh, double spacing);

}  // namespace verisim::shape
