// SPDX-License-Identifier: MIT
// What a world is made from: plain input that the scene loader fills and make_world checks.
#pragma once

#include <Eigen/Core>
#include <optional>
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

/// A piece of a surface that moving air can press on.
struct DragPatch {
  Eigen::Vector3d position_b;  // m, from the centre of mass
  Eigen::Vector3d normal_b;    // unit, outward
  double area;                 // m^2
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
  std::vector<DragPatch> drag_patches;                  // read where there is wind; a ball has none
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
  NormalLaw contact_law = NormalLaw::kHuntCrossley;
  TangentialLaw tangential_law = TangentialLaw::kSpring;
};

/// Choices of method `xpbd`.
struct XpbdSettings {
  int substeps = 20;  // of a frame
};

/// Air that moves past the bodies; see wind.h.
struct Wind {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s
  double density = 1.2;                                // kg/m^3
  double viscosity = 1.8e-5;                           // Pa s, of the drag of spheres
  double drag_coefficient = 1;                         // of surfaces across the wind, but spheres
};

/// An inextensible line from a point of a body to a point of the world or of another body; see
/// tethers.h.
struct TetherDefinition {
  int body = -1;
  Eigen::Vector3d attach_b = Eigen::Vector3d::Zero();  // m, frame of the body
  int other = -1;                                      // the second body; -1: the world
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();    // m, world or frame of the second body
  double length = -1;  // m; 0: a ball joint; < 0: the distance at the start
};

/// How pairs of materials meet, row-major [M][M], symmetric.
struct MaterialPairs {
  int count = 0;                              // M
  std::vector<double> restitution;            // [M * M]
  std::vector<double> friction;               // [M * M]
  std::vector<double> rolling_friction = {};  // [M * M]; of spheres; empty: none
  // Of the materials themselves [M], read by Hertz and Mindlin's law.
  std::vector<double> young_modulus = {};  // Pa
  std::vector<double> poisson_ratio = {};
  std::size_t at(int a, int b) const { return static_cast<std::size_t>(a * count + b); }
};

struct WorldDefinition {
  Method method = Method::kSeed;
  Eigen::Vector3d gravity = Eigen::Vector3d(0, 0, -9.81);  // m/s^2
  std::vector<BodyDefinition> bodies;
  std::vector<PlaneDefinition> planes;
  SeedSettings seed;
  DemSettings dem;
  XpbdSettings xpbd;
  std::optional<Wind> wind;               // read by `dem` and `xpbd`
  std::vector<TetherDefinition> tethers;  // read by `dem`
  MaterialPairs material_pairs;           // read by `dem`
  Integrator integrator = Integrator::kSeed;
  double dt = 0;  // s
  int num_threads = 1;
};

/// Everything wrong with a definition, one sentence each; empty if it can run.
std::vector<std::string> problems_of(const WorldDefinition& definition);

}  // namespace verisim::dem
