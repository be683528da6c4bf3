// SPDX-License-Identifier: MIT
// Two bodies that touch or soon may, and the points between them: springs that persist.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace verisim::dem {

/// How two materials meet.
struct PairLaw {
  double restitution = 0.5;
  double friction = 0.5;
  double rolling_friction = 0;  // m of lever / m of radius; spheres only
  double radius = 0;            // m, of two spheres, or a sphere and what is flat: 1 / (1/a + 1/b)
  double hertz = 0;             // N/m^1.5: force over compression^1.5 (Hertz)
  double mindlin = 0;           // tangential over normal stiffness (Mindlin)
};

/// The places of two bodies that gripped each other when a point last slid or began.
struct Anchor {
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = Eigen::Vector3d::Zero();  // m, body frames
  Eigen::Vector3d stretch_b = Eigen::Vector3d::Zero();                       // m, of then
  bool holds = false;
};

/// One spring between two surfaces. Its energy is stiffness/2 (depth - offset)^2 along the normal
/// and tangential stiffness/2 |stretch|^2 across it.
struct ContactPoint {
  std::uint64_t id = 0;  // which features meet; keeps its springs while they do
  Eigen::Vector3d place = Eigen::Vector3d::Zero();    // m, world
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, pushes a away from b
  double depth = 0;   // m, > 0 where the surfaces overlap, < 0 apart
  double weight = 1;  // share of the pair's stiffness that this point carries
  double offset = 0;  // m, depth at which the spring is at rest: 0 but for springs that were
                      // stiffened or born under load
  Eigen::Vector3d stretch_b = Eigen::Vector3d::Zero();  // m, tangential, frame of body b
  Eigen::Vector3d rolled_b = Eigen::Vector3d::Zero();   // m, the same of the rolling spring
  double shear = 0;                                     // N/m, of the tangential spring (Mindlin)
  double load = 0;                                      // N, last normal force
  double expected = 0;  // m, depth that the last implicit step aimed at
  bool is_touching = false;
  bool has_slid = false;  // since the anchor was set
  Anchor anchor;          // see anchor_creep.h
};

struct ContactPair {
  int a = -1, b = -1;  // bodies of the world; planes follow the bodies
  PairLaw law;
  std::vector<ContactPoint> points;
  double stiffness = 0;       // N/m of a point of weight 1
  double approach_speed = 0;  // m/s, at the onset of this contact: the scale of its damping
  double mean_load = 0;       // N, of the heaviest point, smoothed over some milliseconds
  double gap = 0;             // m, lower bound of the distance at the last look; < 0: overlap
  Eigen::Vector3d gap_normal = Eigen::Vector3d::UnitZ();
  double look_margin = 0;           // m, farthest gap that the last look took in
  bool gap_is_along_normal = true;  // the normal is a separating axis of two convex shapes
  int last_axis = -1;               // of two boxes: the axis of least overlap found last
  bool is_touching = false;
  bool is_compressing = false;
  bool is_in_impact = false;  // its last step was an explicit one

  std::uint64_t key() const {
    return (static_cast<std::uint64_t>(a) << 32) | static_cast<std::uint32_t>(b);
  }
};

}  // namespace verisim::dem
