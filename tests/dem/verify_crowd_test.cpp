// SPDX-License-Identifier: MIT
// Islands of many bodies: impacts within implicit steps, what surfaces turn into, threads.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "verify_worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

namespace {

/// Cubes of 0.2 m in random orientations above each other in columns of 2 x 2.
VERISIM_OUT_OF_LINE std::vector<BodyDefinition> tumbled_cubes(int count, double x, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> normal;
  std::vector<BodyDefinition> cubes;
  for (int i = 0; i < count; ++i) {
    const Vector3d place(x + 0.36 * (i % 2), 0.36 * (i / 2 % 2), 0.2 + 0.36 * (i / 4));
    cubes.push_back(solid_box({0.2, 0.2, 0.2}, 8, place));
    const double w = normal(rng), a = normal(rng), b = normal(rng), c = normal(rng);
    cubes.back().initial.orientation = Eigen::Quaterniond(w, a, b, c).normalized();
  }
  return cubes;
}

/// Bits of all poses and speeds after a run.
VERISIM_OUT_OF_LINE std::vector<double> end_of(WorldDefinition definition, int num_threads) {
  definition.num_threads = num_threads;
  World world = make_world(definition);
  RunOptions options;
  options.duration = 0.8;
  options.sample_interval = definition.dt;
  run(world, options);
  std::vector<double> bits;
  for (int b = 0; b < world.bodies.count(); ++b) {
    for (const Vector3d* v : {&world.bodies.position[b], &world.bodies.linear_velocity[b],
                              &world.bodies.angular_momentum[b]}) {
      bits.insert(bits.end(), v->data(), v->data() + 3);
    }
  }
  return bits;
}

}  // namespace

TEST_CASE("a_throng_rebounds_by_its_restitution") {
  for (const double restitution : {0.3, 0.5, 0.8}) {
    std::vector<BodyDefinition> balls;
    for (int i = 0; i < 24; ++i) balls.push_back(solid_ball(0.05, 1000, {0.1001 * i, 0, 0.25}));
    WorldDefinition definition = floor_world(balls, restitution, 0.3);
    definition.dt = 1.0 / 240;
    const Watched watched = watch(definition, 0.45);
    // Height that the first frame upward leads to, against the fall's.
    double worst = 0;
    for (std::size_t b = 0; b < balls.size(); ++b) {
      for (std::size_t t = 1; t < watched.result.log.num_times(); ++t) {
        const Pose& pose = watched.result.log.at(t, b);
        const double speed = pose.linear_velocity.z();
        if (speed <= 0) continue;
        const double apex = pose.position.z() - 0.05 + speed * speed / (2 * kGravity);
        worst = std::max(worst, std::abs(std::sqrt(apex / 0.2) / restitution - 1));
        break;
      }
    }
    tell("throng: restitution, its error, rise", restitution, worst, watched.rise_rel);
    CHECK_FALSE(watched.result.failed.has_value());
    CHECK(worst < 0.03);             // measured 1.9e-2, 1.5e-2, 1.0e-2 at 1/240 s
    CHECK(watched.rise_rel < 1e-6);  // measured 5e-16
  }
}

TEST_CASE("a_tumbling_crowd_gains_no_energy_from_surfaces_that_turn_into_each_other") {
  const Watched watched = watch(floor_world(tumbled_cubes(12, 0, 5), 0.0, 0.5), 3);
  const double allowed = watched.world.surfaces->chosen().max_penetration;
  tell("tumbling crowd: penetration over allowed, rise, residual, momentum, at rest since",
       watched.result.metrics.max_penetration_m / allowed, watched.rise_rel,
       watched.result.metrics.energy_residual_rel, watched.momentum_rel, watched.at_rest_since);
  CHECK_FALSE(watched.result.failed.has_value());
  CHECK(watched.result.metrics.max_penetration_m < 2 * allowed);  // measured 1.3
  CHECK(watched.rise_rel < 1e-6);                                 // measured 3e-16
  CHECK(watched.result.metrics.energy_residual_rel < 1e-3);       // measured 9e-8
  CHECK(watched.at_rest_since >= 0);                              // measured 1.25 s
}

TEST_CASE("crowds_have_the_same_bits_for_any_number_of_threads") {
  std::vector<BodyDefinition> bodies;
  for (int heap = 0; heap < 5; ++heap) {
    for (const BodyDefinition& cube : tumbled_cubes(4 + 3 * heap, 3.0 * heap, 7u)) {
      bodies.push_back(cube);
    }
  }
  const WorldDefinition definition = floor_world(bodies, 0.2, 0.5);
  const std::vector<double> reference = end_of(definition, 1);
  for (const int num_threads : {2, 3, 4}) {
    const std::vector<double> bits = end_of(definition, num_threads);
    REQUIRE(bits.size() == reference.size());
    CHECK(std::memcmp(bits.data(), reference.data(), bits.size() * sizeof(double)) == 0);
  }
}
