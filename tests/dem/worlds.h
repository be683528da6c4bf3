// SPDX-License-Identifier: MIT
// Small bodies and worlds that the tests of engine/dem share.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "dem/run.h"
#include "dem/world.h"

// Inlined everywhere, these make the sanitizer build of a test take minutes.
#define VERISIM_OUT_OF_LINE [[gnu::noinline]] inline

namespace verisim::dem::testing {

/// Solid ball; of one particle in method seed.
VERISIM_OUT_OF_LINE BodyDefinition ball(double radius, double mass,
                                        const Eigen::Vector3d& position) {
  BodyDefinition body;
  body.name = "ball";
  body.mass = mass;
  body.inertia_b = 0.4 * mass * radius * radius * Eigen::Matrix3d::Identity();
  body.initial.position = position;
  body.shape = SphereShape{radius};
  body.particle_offsets_b = {Eigen::Vector3d::Zero()};
  body.particle_radius = radius;
  body.size = 2 * radius;
  return body;
}

/// Solid box of edges (m) filled with a lattice of particles of the given diameter.
VERISIM_OUT_OF_LINE BodyDefinition box(const Eigen::Vector3d& edges, double diameter, double mass,
                                       const Eigen::Vector3d& position) {
  BodyDefinition body;
  body.name = "box";
  body.mass = mass;
  const Eigen::Vector3d squares = edges.cwiseProduct(edges);
  body.inertia_b = (mass / 12 * (squares.sum() * Eigen::Vector3d::Ones() - squares)).asDiagonal();
  body.initial.position = position;
  body.shape = BoxShape{0.5 * edges, nullptr};
  body.particle_radius = diameter / 2;
  body.size = edges.minCoeff();
  const Eigen::Vector3i cells = (edges / diameter).array().round().cast<int>();
  for (int z = 0; z < cells.z(); ++z) {
    for (int y = 0; y < cells.y(); ++y) {
      for (int x = 0; x < cells.x(); ++x) {
        body.particle_offsets_b.push_back(
            diameter * (Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5) - 0.5 * cells.cast<double>()));
      }
    }
  }
  return body;
}

VERISIM_OUT_OF_LINE BodyDefinition cube(double edge, int particles_per_edge, double mass,
                                        const Eigen::Vector3d& position) {
  BodyDefinition body =
      box(Eigen::Vector3d(edge, edge, edge), edge / particles_per_edge, mass, position);
  body.name = "cube";
  return body;
}

/// No particles: only its inertia matters.
VERISIM_OUT_OF_LINE BodyDefinition rotor(const Eigen::Matrix3d& inertia_b,
                                         const Eigen::Vector3d& spin) {
  BodyDefinition body;
  body.name = "rotor";
  body.mass = 1;
  body.inertia_b = inertia_b;
  body.initial.angular_velocity = spin;
  body.size = 1;
  return body;
}

VERISIM_OUT_OF_LINE WorldDefinition world_of(std::vector<BodyDefinition> bodies, double stiffness,
                                             double dt) {
  WorldDefinition definition;
  definition.bodies = std::move(bodies);
  definition.seed.stiffness = stiffness;
  definition.dt = dt;
  return definition;
}

/// Method dem with one material and no floor.
VERISIM_OUT_OF_LINE WorldDefinition dem_world_of(std::vector<BodyDefinition> bodies,
                                                 double restitution, double friction) {
  WorldDefinition definition = world_of(std::move(bodies), 0, 1.0 / 60);
  definition.method = Method::kDem;
  definition.integrator = Integrator::kRkmk4;
  definition.material_pairs = {1, {restitution}, {friction}};
  return definition;
}

inline void run_steps(World& world, long count) {
  for (long n = 0; n < count; ++n) step(world);
}

VERISIM_OUT_OF_LINE RunOptions for_seconds(double duration) {
  RunOptions options;
  options.duration = duration;
  options.sample_interval = 1.0 / 60;
  return options;
}

VERISIM_OUT_OF_LINE bool has_code(const RunResult& result, const std::string& code) {
  for (const Failure& failure : result.failures) {
    if (failure.code == code) return true;
  }
  return false;
}

VERISIM_OUT_OF_LINE std::string codes_of(const RunResult& result) {
  std::string codes;
  for (const Failure& failure : result.failures) codes += failure.code + " ";
  return codes;
}

}  // namespace verisim::dem::testing
