// SPDX-License-Identifier: MIT
// The same bits for any number of threads.
#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

namespace {

WorldDefinition pile(int num_threads) {
  std::vector<BodyDefinition> bodies;
  for (int n = 0; n < 300; ++n) {
    const Eigen::Vector3d place(n % 6 * 0.041 + 0.001 * (n % 7), n / 6 % 5 * 0.041,
                                0.021 + n / 30 * 0.041);
    bodies.push_back(n % 3 == 0 ? cube(0.04, 2, 0.1, place) : ball(0.02, 0.08, place));
    bodies.back().initial.angular_velocity = {0.1 * (n % 5), 1, 0};
  }
  WorldDefinition definition = world_of(std::move(bodies), 5e3, 1e-4);
  definition.planes.push_back({});
  definition.num_threads = num_threads;
  return definition;
}

/// All bits of the state and of the books.
std::vector<double> bits_of(const World& world) {
  std::vector<double> bits;
  for (int b = 0; b < world.bodies.count(); ++b) {
    for (const Eigen::Vector3d* v : {&world.bodies.position[b], &world.bodies.linear_velocity[b],
                                     &world.bodies.angular_momentum[b]}) {
      bits.insert(bits.end(), v->data(), v->data() + 3);
    }
    const double* q = world.bodies.orientation[b].coeffs().data();
    bits.insert(bits.end(), q, q + 4);
  }
  const Metrics metrics = metrics_of(world);
  bits.insert(bits.end(), {metrics.energy_end_j, metrics.damping_work_j, metrics.friction_work_j,
                           metrics.mean_penetration_m, metrics.momentum_residual_rel});
  return bits;
}

bool are_same(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

}  // namespace

TEST_CASE("state_books_and_events_are_bit_identical_for_any_number_of_threads") {
  for (const Integrator integrator : {Integrator::kSeed, Integrator::kRkmk4}) {
    std::vector<double> reference;
    std::vector<double> reference_events;
    for (const int num_threads : {1, 2, 3, 4}) {
      WorldDefinition definition = pile(num_threads);
      definition.integrator = integrator;
      World world = make_world(definition);
      std::vector<double> events;
      for (int n = 0; n < 500; ++n) {
        step(world);
        for (const ContactEvent& event : world.contacts.events) {
          events.insert(events.end(), {event.time, event.speed, 1.0 * event.body_a,
                                       1.0 * event.body_b, 1.0 * event.plane});
        }
      }
      REQUIRE(world.rows.count() > 3 * kRowBlock);  // so that every thread has rows
      REQUIRE(world.balance.contacts.num_contacts > 300);
      if (num_threads == 1) {
        reference = bits_of(world);
        reference_events = events;
        REQUIRE(events.size() > 100);
      }
      CHECK(are_same(bits_of(world), reference));
      CHECK(are_same(events, reference_events));
    }
  }
}
