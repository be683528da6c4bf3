// SPDX-License-Identifier: MIT
// Speed of method `seed` on a settled bed of spheres: time per particle and step.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "dem/world.h"

namespace {

using verisim::dem::WorldDefinition;

constexpr double kRadius = 0.005;    // m
constexpr double kDensity = 2500;    // kg/m^3
constexpr double kStiffness = 1000;  // N/m
constexpr double kDt = 4e-5;         // s, about 29 steps per contact of two spheres
constexpr int kSettleSteps = 6000;   // until the bed is at rest
constexpr int kStepsPerRepeat = 500;
constexpr int kRepeats = 5;

verisim::dem::BodyDefinition sphere(const Eigen::Vector3d& position) {
  verisim::dem::BodyDefinition body;
  body.mass = kDensity * 4.0 / 3 * EIGEN_PI * std::pow(kRadius, 3);
  body.inertia_b = 0.4 * body.mass * kRadius * kRadius * Eigen::Matrix3d::Identity();
  body.initial.position = position;
  body.particle_offsets_b = {Eigen::Vector3d::Zero()};
  body.particle_radius = kRadius;
  body.size = 2 * kRadius;
  return body;
}

/// A loose, disturbed lattice of `count` spheres in a box without lid.
WorldDefinition bed_of(int count, int num_threads) {
  WorldDefinition definition;
  definition.seed.stiffness = kStiffness;  // critical damping, as in the source
  definition.dt = kDt;
  definition.num_threads = num_threads;
  const double spacing = 2.1 * kRadius;
  const int side = static_cast<int>(std::lround(std::cbrt(count)));
  const double wall = 0.5 * side * spacing;
  std::mt19937 generator(1);
  const auto disturbance = [&] {
    return 0.05 * kRadius * (static_cast<double>(generator()) / 4294967296.0 * 2 - 1);
  };
  for (int n = 0; n < count; ++n) {
    const Eigen::Vector3d place(n % side - 0.5 * (side - 1), n / side % side - 0.5 * (side - 1),
                                n / (side * side) + 0.5);
    definition.bodies.push_back(
        sphere(spacing * place + Eigen::Vector3d(disturbance(), disturbance(), disturbance())));
    definition.bodies.back().name = "sphere_" + std::to_string(n);
  }
  definition.planes.push_back({});
  for (const Eigen::Vector3d& normal : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0),
                                        Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, -1, 0)}) {
    definition.planes.push_back({normal, -wall, 0, "wall"});
  }
  return definition;
}

double seconds_for(verisim::dem::World& world, int num_steps) {
  const auto begin = std::chrono::steady_clock::now();
  for (int n = 0; n < num_steps; ++n) step(world);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 10000;
  const int num_threads = argc > 2 ? std::atoi(argv[2]) : 1;
  if (argc > 3 || count < 1 || num_threads < 1) {
    std::fprintf(stderr, "use: bench_packed_spheres [spheres [threads]]\n");
    return 2;
  }
  verisim::dem::World world = make_world(bed_of(count, num_threads));
  seconds_for(world, kSettleSteps);
  const long rebuilds = world.neighbours.num_rebuilds;
  double best = 0, total = 0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const double seconds = seconds_for(world, kStepsPerRepeat);
    total += seconds;
    best = repeat == 0 ? seconds : std::min(best, seconds);
  }
  const double ns_best = 1e9 * best / kStepsPerRepeat / count;
  const double ns_mean = 1e9 * total / (kRepeats * kStepsPerRepeat) / count;
  std::printf("spheres %d  threads %d  contacts per sphere %.2f  mean speed %.1e m/s\n", count,
              num_threads, 2.0 * static_cast<double>(world.balance.contacts.num_contacts) / count,
              std::sqrt(2 * world.balance.kinetic_energy / (count * world.bodies.mass[0])));
  std::printf("ns per particle-step: best %.1f  mean %.1f  (rebuilds in %d steps: %ld)\n", ns_best,
              ns_mean, kRepeats * kStepsPerRepeat, world.neighbours.num_rebuilds - rebuilds);
  std::printf("million particle-steps per second: best %.1f  mean %.1f\n", 1e3 / ns_best,
              1e3 / ns_mean);
  return 0;
}
