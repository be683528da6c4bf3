// SPDX-License-Identifier: MIT
// Volume, centre of mass and inertia of solids of unit density.
#pragma once

#include <Eigen/Core>

#include "shape/mesh.h"

namespace verisim::shape {

/// Multiply volume and inertia by a density (kg/m^3) to get mass (kg) and inertia (kg m^2).
struct MassProperties {
  double volume;                   // m^3
  Eigen::Vector3d center_of_mass;  // m, frame of the shape
  Eigen::Matrix3d inertia;         // m^5, about the centre of mass, axes of the shape
};

/// Exact (to rounding) for the polyhedron that a closed mesh bounds; volume and inertia of an
/// inside-out mesh come out negative. The mesh must pass `check_mesh`.
/// Source: volume integrals of polynomials reduced to the faces, Mirtich 1996; here summed as
/// signed tetrahedra between each triangle and the mean vertex, with the closed form of the second
/// moments of a tetrahedron, Eberly 2002. The mean vertex as origin keeps a far-off mesh
/// well-conditioned.
MassProperties mesh_mass_properties(const Mesh& mesh);

/// Volume alone, m^3, negative when inside out.
double signed_volume(const Mesh& mesh);

/// Box with full edge lengths `edges` (m), centred on the origin.
MassProperties box_mass_properties(const Eigen::Vector3d& edges);

/// Ball of `radius` (m), centred on the origin.
MassProperties sphere_mass_properties(double radius);

}  // namespace verisim::shape
