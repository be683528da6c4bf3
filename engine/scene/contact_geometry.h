// SPDX-License-Identifier: MIT
// What contacts need of a mesh body: its distance field and its surface points, made from the mesh.
#pragma once

#include "dem/mesh_surface.h"
#include "shape/mesh.h"

namespace verisim::scene {

/// A twelfth of the smallest extent (m), wider where that would give more than 2000 points.
/// Cost: that of sampling the surface a few times.
double default_sample_spacing(const shape::Mesh& mesh);

/// Field and points of a solid whose mesh is given in the body frame, origin at its centre of mass.
/// sample_spacing: m. Points lie in blocks of neighbours; weights are what SurfacePoint says.
/// Throws shape::MeshError for a mesh that is no solid and for a spacing that is not usable.
/// Cost: 0.1 to 1 s, nearly all for the field.
dem::MeshSurface make_mesh_surface(const shape::Mesh& mesh_from_com, double sample_spacing);

}  // namespace verisim::scene
