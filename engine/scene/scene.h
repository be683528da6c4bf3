// SPDX-License-Identifier: MIT
// A scene as read from its file: SI units, names resolved to indices, defaults filled in.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dem/definition.h"

namespace verisim::scene {

struct Material {
  std::string name;
  double density = 0;        // kg/m^3
  double restitution = 0.5;  // -
  double friction = 0.5;     // -
  double rolling_friction = 0;
  std::optional<double> young_modulus;  // Pa
  std::optional<double> poisson_ratio;
};

struct MaterialPair {
  int a = 0, b = 0;  // material indices
  std::optional<double> restitution, friction, rolling_friction;
};

enum class ShapeKind { kBox, kSphere, kMesh };

struct ShapeSpec {
  ShapeKind kind = ShapeKind::kSphere;
  Eigen::Vector3d box = Eigen::Vector3d::Zero();  // m, full edges
  double radius = 0;                              // m
  std::filesystem::path mesh;                     // resolved against the scene's folder
  double scale = 1;                               // m per mesh unit
};

struct Body {
  std::string name;
  ShapeSpec shape;
  int material = 0;
  dem::Pose initial;
  dem::Motion motion = dem::Motion::kFree;
  std::filesystem::path poses_file;  // of a prescribed body
  dem::PrescribedMotion prescribed;  // filled by the caller, who reads the pose log
};

struct Ground {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0;  // m
  int material = 0;
};

/// Physics as named in the file; what is absent is chosen when the world is built.
struct Physics {
  dem::Method method = dem::Method::kDem;
  std::string integrator;               // empty: the method's own default
  std::optional<double> particle_size;  // m
  std::optional<double> dt;             // s
  std::optional<double> stiffness;      // N/m
  // Method dem.
  std::optional<double> max_penetration;  // m
  std::optional<int> steps_per_contact;
  dem::NormalLaw contact_law = dem::NormalLaw::kHuntCrossley;
  dem::TangentialLaw tangential_law = dem::TangentialLaw::kSpring;
  std::optional<int> substeps;  // of method xpbd
  // Method seed.
  double damping_ratio = 1;
  double tangential_damping_ratio = 0.5;
};

struct Camera {
  Eigen::Vector3d position, look_at;  // m
  double fov_deg = 40;                // vertical
};

struct Look {
  std::string skin = "checker";
  double ground_checker = 0.25;  // m
};

struct Scene {
  std::filesystem::path file;
  std::string name, purpose;
  double duration = 0;     // s
  double frame_rate = 60;  // Hz
  long long seed = 1;
  Eigen::Vector3d gravity{0, 0, -9.81};  // m/s^2
  std::vector<Material> materials;
  std::vector<MaterialPair> material_pairs;
  std::vector<Body> bodies;
  std::optional<Ground> ground;
  Physics physics;
  std::optional<dem::Wind> wind;
  std::vector<dem::TetherDefinition> tethers;
  std::vector<int> stands;  // body indices that must stand
  std::optional<Camera> camera;
  Look look;
  std::string resolved_yaml;  // the file with overrides applied
};

}  // namespace verisim::scene
