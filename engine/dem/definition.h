// SPDX-License-Identifier: MIT
// What a world is made from: plain input that the scene loader fills and make_world checks.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dem/collision_shape.h"
#include "dem/pose_log.h"
#include "dem/types.h"

namespace verisim::dem {

/// Poses over time. Between two times: position by the cubic through both positions and
/// velocities, orientation by slerp; velocities are derived from that path, so only the
/// `linear_velocity` of the given poses is read (the slope at the time). Held past both ends.
struct PrescribedMotion {
  std::vector<double> times;  // s, rising
  std::vector<Pose> poses;    // one per time
};

struct BodyDefinition {
  std::string name;
  Motion motion = Motion::kFree;
  double mass = 0;                                      // kg
  Eigen::Matrix3d inertia_b = Eigen::Matrix3d::Zero();  // kg m^2, about the centre of mass
  Pose initial;                                         // pose and velocities at time 0
  int material = 0;                                     // index; `seed` reads none
  CollisionShape shape;                                 // `dem` alone reads it
  std::vector<Eigen::Vector3d> particle_offsets_b;      // m, from the centre of mass
  double particle_radius = 0;                           // m, the same for all of the body
  double size = 0;                                      // m, smallest extent of the shape
  PrescribedMotion prescribed;                          // read if kPrescribed
};

/// Solid half-space below the plane normal . x = offset.
struct PlaneDefinition {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, pointing out of the solid
  double offset = 0;                                  // m
  int material = 0;                                   // the scene's; `seed` reads none
  std::string name = "ground";
};

/// The contact law of the source; see contact_law.h.
struct SeedSettings {
  double stiffness = 0;                   // N/m per particle contact
  double damping_ratio = 1;               // of 2 sqrt(stiffness * effective particle mass)
  double tangential_damping_ratio = 0.5;  // viscous, of the same critical value
};

/// Choices of method `dem`; 0 means: chosen from what the scene allows.
struct DemSettings {
  double max_penetration = 0;  // m; 0.1 % of the smallest free body
  double stiffness = 0;        // N/m of one contact point; from impact and load
  int steps_per_contact = 40;
  bool rests_implicitly = true;  // false: explicit steps throughout
};

/// How pairs of materials meet, row-major [M][M], symmetric.
struct MaterialPairs {
  int count = 0;                    // M
  std::vector<double> restitution;  // [M * M]
  std::vector<double> friction;     // [M * M]
  std::size_t at(int a, int b) const { return static_cast<std::size_t>(a * count + b); }
};

struct WorldDefinition {
  Method method = Method::kSeed;
  Eigen::Vector3d gravity = Eigen::Vector3d(0, 0, -9.81);  // m/s^2
  std::vector<BodyDefinition> bodies;
  std::vector<PlaneDefinition> planes;
  SeedSettings seed;
  DemSettings dem;
  MaterialPairs material_pairs;  // read by `dem`
  Integrator integrator = Integrator::kSeed;
  double dt = 0;  // s
  int num_threads = 1;
};

/// Everything wrong with a definition, one sentence each; empty if it can run.
std::vector<std::string> problems_of(const WorldDefinition& definition);

}  // namespace verisim::dem
