// SPDX-License-Identifier: MIT
// State of all bodies as parallel arrays, one entry per body in file order.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "dem/definition.h"
#include "dem/types.h"

namespace verisim::dem {

/// Force and torque about the centre of mass, per body.
struct Wrenches {
  std::vector<Eigen::Vector3d> force;   // N
  std::vector<Eigen::Vector3d> torque;  // N m
};

struct Bodies {
  // State. Linear velocity and angular momentum are advanced, angular velocity follows from them.
  std::vector<Eigen::Vector3d> position;          // m, centre of mass
  std::vector<Eigen::Quaterniond> orientation;    // q_wb
  std::vector<Eigen::Vector3d> linear_velocity;   // m/s
  std::vector<Eigen::Vector3d> angular_momentum;  // kg m^2/s, about the centre of mass
  std::vector<Eigen::Vector3d> angular_velocity;  // rad/s

  // Loads of the last evaluation; each is a part of `total` or all of it.
  Wrenches total;     // contacts, gravity, outside
  Wrenches damping;   // normal dashpots alone
  Wrenches friction;  // tangential forces alone
  Wrenches outside;   // set from outside (viewer, modules), held until changed

  // Constants.
  std::vector<Motion> motion;
  std::vector<double> mass;                        // kg
  std::vector<double> inverse_mass;                // 1/kg
  std::vector<Eigen::Matrix3d> inertia_b;          // kg m^2
  std::vector<Eigen::Matrix3d> inverse_inertia_b;  // 1 / (kg m^2)
  std::vector<double> inverse_inertia_all_axes;    // same on every axis; 0 if it is not
  std::vector<double> size;                        // m, smallest extent
  std::vector<double> particle_radius;             // m
  std::vector<double> reach;                       // m, farthest particle centre from the centre
  std::vector<int> first_particle;                 // [B + 1] into Particles
  std::vector<PrescribedMotion> prescribed;

  int count() const { return static_cast<int>(position.size()); }
  int num_particles(int body) const { return first_particle[body + 1] - first_particle[body]; }
};

/// Particles in file order, grouped by body; fixed in their body.
struct Particles {
  std::vector<Eigen::Vector3d> offset_b;  // m, from the body's centre of mass
  std::vector<int> body;

  int count() const { return static_cast<int>(body.size()); }
};

Bodies make_bodies(const WorldDefinition& definition);
Particles make_particles(const WorldDefinition& definition);

/// Angular velocity (rad/s, world) that belongs to an angular momentum at an orientation.
inline Eigen::Vector3d angular_velocity_of(const Eigen::Matrix3d& inverse_inertia_b,
                                           const Eigen::Quaterniond& q_wb,
                                           const Eigen::Vector3d& angular_momentum) {
  return q_wb * (inverse_inertia_b * (q_wb.conjugate() * angular_momentum));
}

/// Angular velocity (rad/s, world) of a body at its present orientation and angular momentum.
inline Eigen::Vector3d angular_velocity_of(const Bodies& bodies, int b) {
  const double all_axes = bodies.inverse_inertia_all_axes[b];
  if (all_axes > 0) return all_axes * bodies.angular_momentum[b];
  return angular_velocity_of(bodies.inverse_inertia_b[b], bodies.orientation[b],
                             bodies.angular_momentum[b]);
}

}  // namespace verisim::dem
