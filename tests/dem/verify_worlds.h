// SPDX-License-Identifier: MIT
// Worlds of the verification suite of method dem, and runs that watch their energy.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <numbers>
#include <string>
#include <vector>

#include "dem/run.h"
#include "dem/surface_contacts.h"
#include "dem/world.h"
#include "worlds.h"

namespace verisim::dem::testing {

using Eigen::Vector3d;

constexpr double kGravity = 9.81;  // m/s^2

/// How a world advances: implicit rest and explicit impacts (the default), or explicit steps alone.
enum class Steps { kHybrid, kExplicit };
constexpr Steps kBothSteps[] = {Steps::kHybrid, Steps::kExplicit};

/// A ball or a box named after its shape, without particles.
VERISIM_OUT_OF_LINE BodyDefinition solid_ball(double radius, double density,
                                              const Vector3d& position) {
  return ball(radius, density * 4.0 / 3 * std::numbers::pi * std::pow(radius, 3), position);
}

VERISIM_OUT_OF_LINE BodyDefinition solid_box(const Vector3d& edges, double mass,
                                             const Vector3d& position) {
  return box(edges, edges.maxCoeff(), mass, position);
}

/// One material, gravity down, floor at z = 0.
VERISIM_OUT_OF_LINE WorldDefinition floor_world(std::vector<BodyDefinition> bodies,
                                                double restitution, double friction,
                                                Steps steps = Steps::kHybrid) {
  WorldDefinition definition = dem_world_of(std::move(bodies), restitution, friction);
  definition.planes.push_back({});
  definition.dem.rests_implicitly = steps == Steps::kHybrid;
  return definition;
}

/// The same without planes and gravity.
VERISIM_OUT_OF_LINE WorldDefinition free_world(std::vector<BodyDefinition> bodies,
                                               double restitution, double friction) {
  WorldDefinition definition = dem_world_of(std::move(bodies), restitution, friction);
  definition.gravity.setZero();
  return definition;
}

/// What a run showed.
struct Watched {
  World world;
  RunResult result;
  std::vector<double> energies;  // J, at every frame: kinetic + potential + elastic - work put in
  double rise_rel = 0;       // largest rise of them from any frame to a later one / energy scale
  double momentum_rel = 0;   // worst residuals of linear and angular momentum
  double at_rest_since = 0;  // s, after which no body moves faster than 1 cm/s; < 0: never

  const Pose& end(std::size_t body) const {
    return result.log.at(result.log.num_times() - 1, body);
  }
};

VERISIM_OUT_OF_LINE Watched watch(const WorldDefinition& definition, double duration) {
  Watched watched{make_world(definition), {}, {}, 0, 0, 0};
  World& world = watched.world;
  RunOptions options;
  options.duration = duration;
  options.sample_interval = definition.dt;
  const auto energy = [&] { return world.balance.energy() - world.balance.outside_work; };
  watched.energies.push_back(energy());
  options.progress = [&](double) { watched.energies.push_back(energy()); };
  watched.result = run(world, options);
  double least = watched.energies.front(), rise = 0;
  for (const double value : watched.energies) {
    least = std::min(least, value);
    rise = std::max(rise, value - least);
  }
  const double scale = watched.result.metrics.energy_scale_j;
  watched.rise_rel = scale > 0 ? rise / scale : 0;
  watched.momentum_rel = std::max(watched.result.metrics.momentum_residual_rel,
                                  watched.result.metrics.angular_momentum_residual_rel);
  const PoseLog& log = watched.result.log;
  for (std::size_t t = 0; t < log.num_times(); ++t) {
    for (std::size_t b = 0; b < log.num_bodies(); ++b) {
      if (log.at(t, b).linear_velocity.norm() > 0.01) watched.at_rest_since = log.times[t];
    }
  }
  if (watched.at_rest_since >= log.times.back()) watched.at_rest_since = -1;
  return watched;
}

/// A rotation in words of the tests: degrees about an axis.
inline Eigen::Quaterniond turned(double degrees, const Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()));
}

/// Two balls (i even) or boxes that meet off centre, spinning, the second three times as heavy.
VERISIM_OUT_OF_LINE WorldDefinition isolated_collision(int i) {
  const bool is_box = i % 2 == 1;
  const auto body_at = [&](double x) {
    return is_box ? solid_box({0.1, 0.14, 0.2}, 1, {x, 0, 0}) : ball(0.08, 1, {x, 0, 0});
  };
  BodyDefinition left = body_at(-0.3), right = body_at(0.3);
  right.mass *= 3;
  right.inertia_b *= 3;
  left.initial.orientation = turned(20 * i, {1, 2, 3});
  right.initial.orientation = turned(35 * i, {-2, 1, 1});
  left.initial.position += Vector3d(0, 0.02, 0.01 * i) + Vector3d(1, 2, 3);
  right.initial.position += Vector3d(1, 2, 3);
  left.initial.linear_velocity = {2, 0.1, 0};
  right.initial.linear_velocity = {-1, 0, 0.05};
  left.initial.angular_velocity = {1, -2, 3};
  right.initial.angular_velocity = {-3, 1, 0.5};
  return free_world({left, right}, 0.6, 0.4);
}

/// Prints what a test measured if the environment has TOL_SCALE=0.
template <class... Values>
void tell(const char* what, const Values&... values) {
  const char* scale = std::getenv("TOL_SCALE");
  if (scale == nullptr || std::string(scale) != "0") return;
  std::cout << what << ":";
  ((std::cout << " " << values), ...);
  std::cout << "\n";
}

inline double radians(double degrees) { return degrees * std::numbers::pi / 180; }

}  // namespace verisim::dem::testing
