// SPDX-License-Identifier: MIT
// Signed distances at grid nodes against closed forms, and which side of the surface a node is on.
#include "shape/distance_grid.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sample_meshes.h"
#include "shape/extents.h"
#include "shape/load_mesh.h"
#include "shape/primitives.h"
#include "shape/triangle_tree.h"

using namespace verisim::shape;

namespace {

double box_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& edges) {
  const Eigen::Vector3d beyond = point.cwiseAbs() - 0.5 * edges;
  return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
}

double torus_distance(const Eigen::Vector3d& point, double ring, double tube) {
  return std::hypot(std::hypot(point.x(), point.y()) - ring, point.z()) - tube;
}

template <typename Visit>  // Visit(point, value)
void for_each_node(const DistanceGrid& grid, Visit visit) {
  std::size_t n = 0;
  for (int k = 0; k < grid.counts[2]; ++k) {
    for (int j = 0; j < grid.counts[1]; ++j) {
      for (int i = 0; i < grid.counts[0]; ++i) visit(grid.node(i, j, k), grid.values[n++]);
    }
  }
}

double interpolated(const DistanceGrid& grid, const Eigen::Vector3d& point) {
  const Eigen::Vector3d cells = (point - grid.origin) / grid.spacing;
  const Eigen::Array3d low = cells.array().floor();
  const Eigen::Array3d t = cells.array() - low;
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::size_t n = 0;
    for (int axis = 2; axis >= 0; --axis) {
      const int upper = corner >> axis & 1;
      weight *= upper ? t[axis] : 1 - t[axis];
      n = n * grid.counts[axis] + static_cast<std::size_t>(low[axis]) + upper;
    }
    sum += weight * grid.values[n];
  }
  return sum;
}

// The solid angle of the mesh seen from a point is 4 pi inside and 0 outside: a test of the side
// that has nothing in common with rays (van Oosterom & Strackee 1983, eq. 8).
double winding_number(const Mesh& mesh, const Eigen::Vector3d& point) {
  double sum = 0;
  for (const auto& [ia, ib, ic] : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[ia] - point, b = mesh.vertices[ib] - point,
                          c = mesh.vertices[ic] - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum +=
        std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (2 * std::numbers::pi);
}

}  // namespace

TEST_CASE("nodes_of_a_box_hold_its_exact_distance") {
  const Eigen::Vector3d edges(0.2, 0.3, 0.5);
  const Mesh box = box_mesh(edges);
  const DistanceGrid grid = make_distance_grid(box, 0.017);
  double worst = 0;
  for_each_node(grid, [&](const Eigen::Vector3d& point, float value) {
    worst = std::max(worst, std::abs(value - box_distance(point, edges)));
  });
  CHECK(worst < 5e-9);  // measured 3.2e-9: the rounding to 32 bits
}

TEST_CASE("distances_to_round_bodies_converge_with_the_mesh") {
  // What is left is the mesh: the facets lie below the sphere and inside or outside the torus.
  double worst = 0;
  for_each_node(make_distance_grid(sphere_mesh(1, 4), 0.2),
                [&](const Eigen::Vector3d& point, float value) {
                  worst = std::max(worst, std::abs(value - (point.norm() - 1)));
                });
  CHECK(worst < 2e-3);  // measured 1.1e-3; 1 - cos of half an edge's angle is 0.7e-3
  worst = 0;
  for_each_node(make_distance_grid(torus_mesh(1, 0.3, 120, 60), 0.1),
                [&](const Eigen::Vector3d& point, float value) {
                  worst = std::max(worst, std::abs(value - torus_distance(point, 1, 0.3)));
                });
  CHECK(worst < 1.5e-3);  // measured 8.5e-4; ring and tube give 4.5e-4 + 4.1e-4
}

TEST_CASE("interpolation_error_falls_with_the_square_of_the_spacing") {
  // Near the surface of a finely meshed torus, away from the circle and axis where the distance
  // has a crease.
  const Mesh torus = torus_mesh(1, 0.4, 160, 80);
  std::vector<double> errors;
  for (double spacing : {0.2, 0.1}) {
    const DistanceGrid grid = make_distance_grid(torus, spacing);
    std::mt19937 rng(5);
    std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi), depth(-0.05, 0.05);
    double sum = 0;
    for (int n = 0; n < 2000; ++n) {
      const double u = angle(rng), v = angle(rng), tube = 0.4 + depth(rng);
      const double radius = 1 + tube * std::cos(v);
      const Eigen::Vector3d point(radius * std::cos(u), radius * std::sin(u), tube * std::sin(v));
      const double error = interpolated(grid, point) - torus_distance(point, 1, 0.4);
      sum += error * error;
    }
    errors.push_back(std::sqrt(sum / 2000));
  }
  CHECK(errors[1] < 4e-3);             // measured 2.3e-3
  CHECK(errors[0] / errors[1] > 3.6);  // measured 3.91; 4 in the limit
}

TEST_CASE("a_thin_plate_has_nodes_inside") {
  const Eigen::Vector3d edges(1, 0.8, 0.01);
  const Mesh plate = box_mesh(edges);
  const double spacing = default_grid_spacing(plate);
  const DistanceGrid grid = make_distance_grid(plate, spacing);
  CHECK(grid.values.size() <= kMaxNumGridNodes);
  CHECK(spacing <= 0.01 / 4 * 1.0001);
  const float deepest = *std::min_element(grid.values.begin(), grid.values.end());
  CHECK(deepest == doctest::Approx(-0.005).epsilon(1e-6));
}

TEST_CASE("default_spacing_keeps_within_the_node_limit") {
  for (const Eigen::Vector3d& edges :
       {Eigen::Vector3d(1, 1, 1), {1, 1, 0.1}, {1, 0.01, 0.01}, {1, 1, 1e-4}, {5, 5e-3, 3}}) {
    const Mesh box = box_mesh(edges);
    const double spacing = default_grid_spacing(box);
    CAPTURE(edges.transpose());
    double nodes = 1;
    for (int axis = 0; axis < 3; ++axis) nodes *= std::ceil(edges[axis] / spacing) + 5;
    CHECK(nodes <= 1.001 * kMaxNumGridNodes);
    CHECK(spacing <= edges.maxCoeff() / 24);
  }
}

TEST_CASE("every_node_of_the_fox_is_on_its_side") {
  const Mesh fox = load_mesh(VERISIM_SOURCE_DIR "/stimuli/meshes/fox.obj");
  const DistanceGrid grid = make_distance_grid(fox, smallest_extent(fox) / 5);
  int num_wrong = 0, num_inside = 0;
  for_each_node(grid, [&](const Eigen::Vector3d& point, float value) {
    const bool inside = winding_number(fox, point) > 0.5;
    num_inside += inside;
    num_wrong += inside != (value < 0);
  });
  CHECK(num_inside > 100);
  CHECK(num_wrong == 0);
}

TEST_CASE("the_margin_is_two_cells_and_lies_outside") {
  const Mesh fox = load_mesh(VERISIM_SOURCE_DIR "/stimuli/meshes/fox.obj");
  const double spacing = smallest_extent(fox) / 9;
  const DistanceGrid grid = make_distance_grid(fox, spacing);
  const Eigen::AlignedBox3d box = bounding_box(fox);
  const Eigen::Vector3d high =
      grid.node(grid.counts[0] - 1, grid.counts[1] - 1, grid.counts[2] - 1);
  CHECK((box.min() - grid.origin).minCoeff() >= 1.9999 * spacing);
  CHECK((high - box.max()).minCoeff() >= 1.9999 * spacing);
  for_each_node(grid, [&](const Eigen::Vector3d& point, float value) {
    if (!box.contains(point)) REQUIRE(value > 0);
  });
}

TEST_CASE("overlapping_parts_are_inside") {
  const Mesh two = merged(box_mesh({1, 1, 1}),
                          moved(box_mesh({1, 1, 1}), Eigen::Quaterniond::Identity(), {0.5, 0, 0}));
  const DistanceGrid grid = make_distance_grid(two, 0.1);
  for_each_node(grid, [&](const Eigen::Vector3d& point, float value) {
    const Eigen::Vector3d from_middle = point - Eigen::Vector3d(0.25, 0, 0);
    if (box_distance(from_middle, {1.49, 0.99, 0.99}) < 0) REQUIRE(value <= 0);
  });
}

TEST_CASE("the_tree_finds_what_a_search_of_all_triangles_finds") {
  const Mesh fox = load_mesh(VERISIM_SOURCE_DIR "/stimuli/meshes/fox.obj");
  const TriangleTree tree(fox);
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> place(-1, 1);
  double worst = 0;
  for (int n = 0; n < 100; ++n) {
    const Eigen::Vector3d point(place(rng), place(rng), place(rng));
    double least = INFINITY;
    for (const auto& [a, b, c] : fox.triangles) {
      const Eigen::Vector3d closest =
          closest_on_triangle(point, fox.vertices[a], fox.vertices[b], fox.vertices[c]);
      least = std::min(least, (closest - point).norm());
    }
    worst = std::max(worst, std::abs(std::sqrt(tree.nearest(point).squared_distance) - least));
  }
  CHECK(worst == 0);
}

TEST_CASE("closest_points_on_a_triangle_lie_on_faces_edges_and_corners") {
  const Eigen::Vector3d a(0, 0, 0), b(4, 0, 0), c(0, 3, 0);
  const auto closest = [&](double x, double y, double z) {
    return closest_on_triangle({x, y, z}, a, b, c);
  };
  CHECK(closest(1, 1, 5) == Eigen::Vector3d(1, 1, 0));
  CHECK(closest(2, -1, 1) == Eigen::Vector3d(2, 0, 0));
  CHECK(closest(-1, -1, -1) == a);
  CHECK(closest(6, -1, 0) == b);
  CHECK(closest(-1, 5, 2) == c);
  CHECK((closest(3.5, 3.5, 1) - Eigen::Vector3d(2, 1.5, 0)).norm() < 1e-12);
  // No area: a needle and a point.
  CHECK(closest_on_triangle({1, 1, 0}, a, b, a) == Eigen::Vector3d(1, 0, 0));
  CHECK(closest_on_triangle({1, 1, 0}, a, a, a) == a);
}

TEST_CASE("grids_of_no_solid_or_without_end_are_refused") {
  Mesh open = box_mesh({1, 1, 1});
  open.triangles.pop_back();
  CHECK_THROWS_WITH_AS(make_distance_grid(open, 0.1), doctest::Contains("open"), MeshError);
  for (double spacing : {0.0, -1.0, double(NAN), 1e-4}) {
    CHECK_THROWS_WITH_AS(make_distance_grid(box_mesh({1, 1, 1}), spacing),
                         doctest::Contains("hint:"), MeshError);
  }
}
