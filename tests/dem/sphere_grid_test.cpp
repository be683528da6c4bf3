// SPDX-License-Identifier: MIT
// The grid finds every close pair, of any sizes, anywhere.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "dem/sphere_grid.h"
#include "worlds.h"

using namespace verisim::dem;

namespace {

using Pairs = std::set<std::pair<int, int>>;

Pairs by_grid(SphereGrid& grid) {
  Pairs pairs;
  std::size_t last_i = 0;
  for_each_close_pair(grid, [&](std::size_t i, std::size_t j) {
    CHECK(i < j);
    CHECK(i >= last_i);
    last_i = i;
    const bool is_new = pairs.insert(std::minmax(grid.items[i].id, grid.items[j].id)).second;
    CHECK(is_new);
  });
  return pairs;
}

Pairs by_all_against_all(const SphereGrid& grid) {
  Pairs pairs;
  for (const SphereGridItem& a : grid.items) {
    for (const SphereGridItem& b : grid.items) {
      const double reach = a.radius + b.radius;
      if (a.id < b.id && (a.position - b.position).squaredNorm() < reach * reach) {
        pairs.insert({a.id, b.id});
      }
    }
  }
  return pairs;
}

SphereGrid cloud(int count, double size_ratio, const Eigen::Vector3d& center) {
  std::mt19937 generator(7);
  const auto random = [&] { return static_cast<double>(generator()) / 4294967296.0; };
  SphereGrid grid;
  for (int id = 0; id < count; ++id) {
    const double radius = 0.02 * std::pow(size_ratio, random() * random());
    const Eigen::Vector3d place = Eigen::Vector3d(random(), random(), random()) * 0.6;
    grid.items.push_back({center + place - Eigen::Vector3d(0.3, 0.3, 0.3), radius, id, {}});
  }
  return grid;
}

}  // namespace

TEST_CASE("the_grid_finds_the_same_pairs_as_all_against_all") {
  for (const double size_ratio : {1.0, 3.0, 30.0, 1000.0}) {
    for (const double far : {0.0, 1e6}) {
      SphereGrid grid = cloud(600, size_ratio, {far, -far, far});
      sort_into_cells(grid);
      const Pairs found = by_grid(grid);
      CHECK(found.size() > 100);
      CHECK(found == by_all_against_all(grid));
    }
  }
}

TEST_CASE("sizes_far_apart_are_sorted_into_levels_and_not_tested_all_against_all") {
  // 8000 small spheres in a row and one large: the pairs with the large one are the close ones.
  SphereGrid grid;
  for (int id = 0; id < 8000; ++id) grid.items.push_back({{0.03 * id, 0, 0}, 0.01, id, {}});
  grid.items.push_back({{30, 0, 0.4}, 0.5, 8000, {}});
  sort_into_cells(grid);
  CHECK(grid.levels.size() == 2);
  CHECK(grid.levels.front().cell_size == doctest::Approx(0.025));
  CHECK(by_grid(grid) == by_all_against_all(grid));
}

TEST_CASE("coordinates_beyond_all_cells_are_defined") {
  SphereGrid grid;
  grid.items.push_back({{1e300, 0, 0}, 0.01, 0, {}});
  grid.items.push_back({{-1e300, 1e15, 0}, 0.01, 1, {}});
  grid.items.push_back({{0, 1e15, 0}, 0.01, 2, {}});
  sort_into_cells(grid);
  CHECK(by_grid(grid).empty());
}

TEST_CASE("a_large_ball_beside_small_particles_rests_on_them") {
  using namespace verisim::dem::testing;
  BodyDefinition table = box({0.3, 0.3, 0.04}, 0.02, 1, {0, 0, 0});
  table.motion = Motion::kFixed;
  BodyDefinition large = ball(0.05, 0.5, {0.013, -0.004, 0.075});
  World world = make_world(world_of({table, large}, 1e5, 5e-5));
  run_steps(world, 4000);
  // The lattice of the table is 2 cm wide: the ball sits between .05 above its top and a bit lower.
  CHECK(world.bodies.position[1].z() > 0.06);
  CHECK(world.bodies.position[1].z() < 0.075);
  CHECK(world.balance.contacts.num_contacts >= 1);
}
