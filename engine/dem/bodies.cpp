// SPDX-License-Identifier: MIT
// Fills the arrays of bodies and particles from a definition.
#include "dem/bodies.h"

#include <algorithm>
#include <cmath>

#include "dem/prescribed.h"

namespace verisim::dem {
namespace {

// A tensor counts as the same on all axes when no entry differs by more than rounding.
constexpr double kSameAxes = 1e-12;

double same_on_all_axes(const Eigen::Matrix3d& inverse_inertia) {
  const double mean = inverse_inertia.trace() / 3;
  const Eigen::Matrix3d difference = inverse_inertia - mean * Eigen::Matrix3d::Identity();
  return difference.cwiseAbs().maxCoeff() <= kSameAxes * mean ? mean : 0;
}

void size_wrenches(Wrenches& wrenches, std::size_t count) {
  wrenches.force.assign(count, Eigen::Vector3d::Zero());
  wrenches.torque.assign(count, Eigen::Vector3d::Zero());
}

void add_body(Bodies& bodies, const BodyDefinition& body, bool has_particles) {
  Pose pose = body.initial;
  if (body.motion == Motion::kPrescribed) pose = pose_at(body.prescribed, 0);
  if (body.motion == Motion::kFixed) {
    pose.linear_velocity.setZero();
    pose.angular_velocity.setZero();
  }
  const Eigen::Quaterniond q = pose.orientation.normalized();
  const Eigen::Matrix3d inverse = body.inertia_b.inverse();
  bodies.position.push_back(pose.position);
  bodies.orientation.push_back(q);
  bodies.linear_velocity.push_back(pose.linear_velocity);
  bodies.angular_velocity.push_back(pose.angular_velocity);
  bodies.angular_momentum.push_back(q * (body.inertia_b * (q.conjugate() * pose.angular_velocity)));
  bodies.motion.push_back(body.motion);
  bodies.mass.push_back(body.mass);
  bodies.inverse_mass.push_back(1 / body.mass);
  bodies.inertia_b.push_back(body.inertia_b);
  bodies.inverse_inertia_b.push_back(inverse);
  bodies.inverse_inertia_all_axes.push_back(same_on_all_axes(inverse));
  bodies.size.push_back(body.size);
  bodies.particle_radius.push_back(body.particle_radius);
  double reach = 0;
  for (const Eigen::Vector3d& offset : body.particle_offsets_b) {
    reach = std::max(reach, offset.norm());
  }
  bodies.reach.push_back(reach);
  const std::size_t num_particles = has_particles ? body.particle_offsets_b.size() : 0;
  bodies.first_particle.push_back(bodies.first_particle.back() + static_cast<int>(num_particles));
  bodies.prescribed.push_back(body.prescribed);
}

}  // namespace

Bodies make_bodies(const WorldDefinition& definition) {
  Bodies bodies;
  bodies.first_particle.push_back(0);
  const bool has_particles = definition.method == Method::kSeed;
  for (const BodyDefinition& body : definition.bodies) add_body(bodies, body, has_particles);
  for (Wrenches* wrenches : {&bodies.total, &bodies.damping, &bodies.friction, &bodies.outside}) {
    size_wrenches(*wrenches, definition.bodies.size());
  }
  return bodies;
}

Particles make_particles(const WorldDefinition& definition) {
  Particles particles;
  int index = 0;
  for (const BodyDefinition& body : definition.bodies) {
    particles.offset_b.insert(particles.offset_b.end(), body.particle_offsets_b.begin(),
                              body.particle_offsets_b.end());
    particles.body.insert(particles.body.end(), body.particle_offsets_b.size(), index++);
  }
  return particles;
}

}  // namespace verisim::dem
