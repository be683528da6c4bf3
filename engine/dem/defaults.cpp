// SPDX-License-Identifier: MIT
// Stiffness and time step for a scene that names none, from its loads and speeds.
#include "dem/defaults.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace verisim::dem {
namespace {

constexpr double kStaticOverlap = 0.01;  // of a particle diameter, under the load from above
constexpr double kImpactOverlap = 0.25;  // of a particle diameter, one particle stopping the body
constexpr double kContactsOfSphere = 6;  // in a dense packing
constexpr double kStepsOfPeriod = 0.1;   // dt omega: 31 steps per contact time pi / omega
constexpr double kStepsOfDamping = 0.4;  // dt gamma: explicit damping is unstable from 2
constexpr double kWayPerStep = 0.25;     // of a particle diameter

bool is_loaded(const BodyDefinition& body) {
  return body.motion == Motion::kFree && !body.particle_offsets_b.empty();
}

double reach_of(const BodyDefinition& body) {
  double reach = 0;
  for (const Eigen::Vector3d& offset : body.particle_offsets_b) {
    reach = std::max(reach, offset.norm());
  }
  return reach;
}

/// Most particles within a diameter of one of the six extremes along the body's axes.
double particles_of_largest_face(const BodyDefinition& body) {
  if (body.particle_offsets_b.size() == 1) return 1;
  long most = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const auto along = [&](const Eigen::Vector3d& offset) { return sign * offset[axis]; };
      double extreme = -std::numeric_limits<double>::infinity();
      for (const auto& offset : body.particle_offsets_b) extreme = std::max(extreme, along(offset));
      // Half a diameter tells one layer of a lattice from the next.
      const auto is_outer = [&](const Eigen::Vector3d& offset) {
        return along(offset) > extreme - body.particle_radius;
      };
      most = std::max<long>(most, std::count_if(body.particle_offsets_b.begin(),
                                                body.particle_offsets_b.end(), is_outer));
    }
  }
  return static_cast<double>(most);
}

/// Height against gravity (m).
double height(const Eigen::Vector3d& up, const BodyDefinition& body) {
  return up.dot(body.initial.position);
}

/// Weight (N) of the body and of the free bodies above it whose bounding spheres overlap its own
/// as seen along gravity.
double weight_on(const WorldDefinition& definition, const BodyDefinition& body) {
  const double g = definition.gravity.norm();
  const Eigen::Vector3d up = -definition.gravity / g;
  double mass = body.mass;
  for (const BodyDefinition& other : definition.bodies) {
    if (&other == &body || !is_loaded(other) || height(up, other) <= height(up, body)) continue;
    const Eigen::Vector3d apart = other.initial.position - body.initial.position;
    const double aside = (apart - up.dot(apart) * up).norm();
    if (aside < 0.5 * (body.size + other.size)) mass += other.mass;
  }
  return mass * g;
}

/// Greatest fall (m): from the body to the lowest plane or body below it.
double fall_of(const WorldDefinition& definition, const BodyDefinition& body) {
  const double g = definition.gravity.norm();
  if (g == 0) return 0;
  const Eigen::Vector3d up = -definition.gravity / g;
  const double start = height(up, body);
  double lowest = start;
  for (const PlaneDefinition& plane : definition.planes) {
    const double slope = plane.normal.dot(up);
    if (slope < 0.1) continue;  // a wall: nothing falls onto it
    const double gap = (plane.normal.dot(body.initial.position) - plane.offset) / slope;
    lowest = std::min(lowest, start - gap);
  }
  for (const BodyDefinition& other : definition.bodies) {
    lowest = std::min(lowest, height(up, other));
  }
  return start - lowest;
}

/// Fastest speed (m/s) along a prescribed path, at its given times and on average between them.
double speed_of_path(const PrescribedMotion& path) {
  double fastest = 0;
  for (std::size_t k = 0; k < path.poses.size(); ++k) {
    fastest = std::max(fastest, path.poses[k].linear_velocity.norm());
    if (k == 0) continue;
    const Eigen::Vector3d way = path.poses[k].position - path.poses[k - 1].position;
    fastest = std::max(fastest, 1.5 * way.norm() / (path.times[k] - path.times[k - 1]));
  }
  return fastest;
}

/// Fastest that anything may hit `body` (m/s).
double impact_speed(const WorldDefinition& definition, const BodyDefinition& body) {
  double others = 0;
  for (const BodyDefinition& other : definition.bodies) {
    if (&other == &body) continue;
    const double speed = other.motion == Motion::kPrescribed ? speed_of_path(other.prescribed)
                         : other.motion == Motion::kFree     ? other.initial.linear_velocity.norm()
                                                             : 0;
    others = std::max(others, speed);
  }
  const double own =
      body.initial.linear_velocity.norm() + body.initial.angular_velocity.norm() * reach_of(body);
  const double start = own + others;
  return std::sqrt(start * start + 2 * definition.gravity.norm() * fall_of(definition, body));
}

double least_stiffness(const WorldDefinition& definition, const BodyDefinition& body) {
  const double diameter = 2 * body.particle_radius;
  const double speed = impact_speed(definition, body);
  const double impact = body.mass * std::pow(speed / (kImpactOverlap * diameter), 2);
  if (definition.gravity.norm() == 0) return impact;
  const double faces = particles_of_largest_face(body);
  return std::max(impact, weight_on(definition, body) / (faces * kStaticOverlap * diameter));
}

double greatest_dt(const WorldDefinition& definition, const BodyDefinition& body) {
  const SeedSettings& seed = definition.seed;
  const auto num_particles = static_cast<double>(body.particle_offsets_b.size());
  const double contacts = num_particles == 1 ? kContactsOfSphere : particles_of_largest_face(body);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(body.inertia_b,
                                                              Eigen::EigenvaluesOnly);
  const double arm = reach_of(body) + body.particle_radius;
  const double turning = arm * arm / solver.eigenvalues().minCoeff();  // 1/kg, about the centre
  // Inverse mass that the contacts see: all of a face pushing straight, or one at the far end,
  // where a normal force cannot turn a lone particle but a tangential one can.
  const double straight = contacts / body.mass;
  const double normal = std::max(straight, 1 / body.mass + (num_particles > 1 ? turning : 0));
  const double tangential = contacts / body.mass + turning * (num_particles > 1 ? 1 : contacts);
  const double omega = std::sqrt(seed.stiffness * normal);
  const double critical = 2 * std::sqrt(seed.stiffness * body.mass / num_particles);
  const double gamma =
      critical * std::max(seed.damping_ratio * normal, seed.tangential_damping_ratio * tangential);
  const double speed = impact_speed(definition, body);
  return std::min({kStepsOfPeriod / omega, kStepsOfDamping / gamma,
                   kWayPerStep * 2 * body.particle_radius / speed});
}

}  // namespace

SeedSettings default_seed_settings(const WorldDefinition& definition) {
  SeedSettings settings;
  for (const BodyDefinition& body : definition.bodies) {
    if (!is_loaded(body)) continue;
    settings.stiffness = std::max(settings.stiffness, least_stiffness(definition, body));
  }
  // Nothing free, or nothing that loads it: any stiffness is as good.
  if (settings.stiffness == 0) settings.stiffness = 1000;
  return settings;
}

double default_dt(const WorldDefinition& definition) {
  double dt = 1e-3;  // s, for what nothing limits: free flight, still smooth when turning
  for (const BodyDefinition& body : definition.bodies) {
    const double spin = body.initial.angular_velocity.norm();
    if (body.motion == Motion::kFree && spin > 0) dt = std::min(dt, kStepsOfPeriod / spin);
    if (is_loaded(body)) dt = std::min(dt, greatest_dt(definition, body));
  }
  return dt;
}

}  // namespace verisim::dem
