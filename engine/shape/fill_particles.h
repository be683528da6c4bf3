// SPDX-License-Identifier: MIT
// Fills solids with equal particles on a regular grid.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "shape/mesh.h"

namespace verisim::shape {

/// Refusal to fill: particle size not usable, too many particles, or none. Ends with a `hint:`.
class FillError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct ParticleFill {
  std::vector<Eigen::Vector3d> centers;    // m, frame of the shape
  double radius = 0;                       // m, of every particle
  std::int64_t num_odd_columns = 0;        // rays that did not leave the mesh: 0 for a closed mesh
  std::int64_t num_overlapping_cells = 0;  // cells inside twice or inside out: 0 for a simple solid
  std::int64_t num_ray_tests = 0;          // work: triangle-column tests
};

/// Two million particles take 48 MB here and far more time than memory in a simulation.
constexpr std::int64_t kDefaultMaxNumParticles = 2'000'000;

/// Particles of diameter `spacing` (m) at the centres of the grid cells that lie inside a closed
/// mesh, ordered by y, x, z. The grid covers the bounding box and is centred on it. A cell is
/// inside when an odd number of crossings lies at or below its centre on the vertical ray through
/// it (ray parity; Harada 2007 fills rigid bodies by depth peeling, which is the same test). An
/// unclosed column (see num_odd_columns) is left empty above its last crossing. Throws FillError
/// when spacing is not a positive number, no cell centre is inside, or more than
/// `max_num_particles` particles or four times as many columns would be needed.
ParticleFill fill_mesh(const Mesh& mesh, double spacing,
                       std::int64_t max_num_particles = kDefaultMaxNumParticles);

/// Box with full edge lengths `edges` (m), centred on the origin. All particles have one diameter:
/// the smallest edge / round(edge / spacing) (at least one) of the three axes. Each axis holds
/// round(edge / diameter) of them, evenly spaced, the outer two touching the faces exactly; where
/// the diameter does not divide an edge, neighbours on it overlap or stand apart by the remainder.
/// An edge too long for one particle to touch both faces gets two. Throws FillError as fill_mesh.
ParticleFill fill_box(const Eigen::Vector3d& edges, double spacing,
                      std::int64_t max_num_particles = kDefaultMaxNumParticles);

/// Ball of `radius` (m): one particle, the ball itself.
ParticleFill fill_sphere(double radius);

}  // namespace verisim::shape
