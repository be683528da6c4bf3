// SPDX-License-Identifier: MIT
// Memory follows particles, not the extent of the world, and a step takes none.
#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "worlds.h"

namespace {
std::atomic<long> num_allocations = 0;
std::atomic<long> bytes_allocated = 0;

void* count_and_allocate(std::size_t size, std::size_t alignment) {
  ++num_allocations;
  bytes_allocated += static_cast<long>(size);
  const std::size_t rounded = (size + alignment - 1) / alignment * alignment;
  void* memory = std::aligned_alloc(alignment, rounded == 0 ? alignment : rounded);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
}  // namespace

// Counts every allocation of this test program.
void* operator new(std::size_t size) { return count_and_allocate(size, 16); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return count_and_allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

using namespace verisim::dem;
using namespace verisim::dem::testing;

namespace {

/// Cubes and balls above a floor, close enough to touch all the time.
WorldDefinition heap(double far, int num_threads) {
  std::vector<BodyDefinition> bodies;
  for (int n = 0; n < 27; ++n) {
    const Eigen::Vector3d place(n % 3 * 0.105, n / 3 % 3 * 0.105, 0.055 + n / 9 * 0.105);
    bodies.push_back(n % 2 == 0 ? cube(0.1, 3, 1, place) : ball(0.05, 0.6, place));
  }
  bodies.back().initial.position.x() += far;
  WorldDefinition definition = world_of(std::move(bodies), 2e4, 1e-4);
  definition.planes.push_back({});
  definition.num_threads = num_threads;
  return definition;
}

}  // namespace

TEST_CASE("a_step_allocates_nothing") {
  for (const int num_threads : {1, 2}) {
    World world = make_world(heap(0, num_threads));
    run_steps(world, 200);
    const long before = num_allocations, rebuilds = world.neighbours.num_rebuilds;
    run_steps(world, 2000);
    CHECK(num_allocations - before == 0);
    CHECK(world.neighbours.num_rebuilds > rebuilds + 5);  // so that rebuilds are covered
  }
}

TEST_CASE("a_body_a_million_metres_away_costs_no_memory") {
  const auto bytes_for = [](double far) {
    const WorldDefinition definition = heap(far, 1);
    const long before = bytes_allocated;
    World world = make_world(definition);
    run_steps(world, 500);
    CHECK(world.bodies.position.back().allFinite());
    return bytes_allocated - before;
  };
  const long here = bytes_for(0);
  CHECK(bytes_for(1e6) <= here);
  CHECK(bytes_for(1e12) <= here);
}
