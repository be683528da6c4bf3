// SPDX-License-Identifier: MIT
// State of one body while an island advances: a copy, so that an island can be taken back.
#pragma once

#include <Eigen/Geometry>
#include <limits>

#include "dem/collision_shape.h"
#include "dem/definition.h"
#include "dem/types.h"

namespace verisim::dem {

struct BodyState {
  // State (world frame).
  Eigen::Vector3d position = Eigen::Vector3d::Zero();               // m, centre of mass
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // q_wb
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();               // m/s
  Eigen::Vector3d angular_momentum = Eigen::Vector3d::Zero();       // kg m^2/s
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();                   // rad/s

  // Follow from the orientation; see refresh.
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();     // of q_wb
  Eigen::Matrix3d inverse_inertia = Eigen::Matrix3d::Zero();  // world axes; 0 unless free

  // Loads of the last evaluation (explicit steps), gravity included.
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // N
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // N m
  // Parts of them: dampers along normals, all tangential forces.
  Eigen::Vector3d damping_force = Eigen::Vector3d::Zero();
  Eigen::Vector3d damping_torque = Eigen::Vector3d::Zero();
  Eigen::Vector3d friction_force = Eigen::Vector3d::Zero();
  Eigen::Vector3d friction_torque = Eigen::Vector3d::Zero();
  bool is_touched = false;  // by a contact: else those parts are 0
  bool is_pushed = false;   // by anything: else all loads are 0
  // What the books take of them; moments about the origin.
  Eigen::Vector3d outside_load = Eigen::Vector3d::Zero();    // N, gravity and from outside
  Eigen::Vector3d outside_moment = Eigen::Vector3d::Zero();  // N m
  double load_size = 0, moment_size = 0;                     // N, N m
  // From outside: viewer, modules; held during a step.
  Eigen::Vector3d outside_force = Eigen::Vector3d::Zero();
  Eigen::Vector3d outside_torque = Eigen::Vector3d::Zero();

  // Bound on what wind and tethers add to the acceleration of any point of the surface (m/s^2).
  double other_acceleration = 0;

  // Implicit step (s) to try next, in a throng: twice the last one that its island took.
  double next_step = std::numeric_limits<double>::infinity();

  // Bounds of the centre's path since the start of the frame (m).
  Eigen::Vector3d path_low = Eigen::Vector3d::Zero(), path_high = Eigen::Vector3d::Zero();

  // Constants.
  const CollisionShape* shape = nullptr;
  const PrescribedMotion* path = nullptr;  // of a prescribed body
  const std::vector<DragPatch>* drag_patches = nullptr;
  Motion motion = Motion::kFixed;
  int index = -1;                       // in the world; planes follow the bodies
  double mass = 0;                      // kg
  double inverse_mass = 0;              // 0 unless free
  double size = 0;                      // m, smallest extent
  double reach = 0;                     // m, farthest surface point from the centre of mass
  double inverse_inertia_all_axes = 0;  // if the same on all axes, else 0
  Eigen::Matrix3d inertia_b = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d inverse_inertia_b = Eigen::Matrix3d::Zero();

  bool is_free() const { return motion == Motion::kFree; }
  Eigen::Vector3d to_body(const Eigen::Vector3d& p) const {
    return rotation.transpose() * (p - position);
  }
  Eigen::Vector3d velocity_at(const Eigen::Vector3d& p) const {
    return velocity + spin.cross(p - position);
  }
};

/// Angular velocity (rad/s) of a free body that belongs to its angular momentum.
inline Eigen::Vector3d spin_of(const BodyState& body) {
  const double all_axes = body.inverse_inertia_all_axes;
  if (all_axes > 0) return all_axes * body.angular_momentum;
  return body.inverse_inertia * body.angular_momentum;
}

/// Rotation matrix, world inertia and spin from orientation and angular momentum.
inline void refresh(BodyState& body) {
  body.rotation = body.orientation.toRotationMatrix();
  if (!body.is_free()) return;
  if (body.inverse_inertia_all_axes > 0) {
    body.inverse_inertia = body.inverse_inertia_all_axes * Eigen::Matrix3d::Identity();
  } else {
    body.inverse_inertia = body.rotation * body.inverse_inertia_b * body.rotation.transpose();
  }
  body.spin = spin_of(body);
}

}  // namespace verisim::dem
