// SPDX-License-Identifier: MIT
// What check_mesh finds, counts and locates, and what it leaves alone.
#include "shape/check_mesh.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "sample_meshes.h"
#include "shape/load_mesh.h"
#include "shape/primitives.h"

using namespace verisim::shape;

namespace {

const MeshProblem* find_problem(const std::vector<MeshProblem>& problems, const std::string& code) {
  for (const MeshProblem& problem : problems) {
    if (problem.code == code) return &problem;
  }
  return nullptr;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("closed_meshes_have_no_problems") {
  CHECK(check_mesh(box_mesh({1, 2, 3})).empty());
  CHECK(check_mesh(sphere_mesh(0.01, 3)).empty());
  CHECK(check_mesh(torus_mesh(0.35, 0.15, 24, 12)).empty());
  CHECK(check_mesh(octahedron_mesh()).empty());
}

TEST_CASE("thin_plate_is_not_flat") { CHECK(check_mesh(box_mesh({1, 1, 1e-4})).empty()); }

TEST_CASE("hollow_body_with_inward_inner_wall_is_a_solid") {
  Mesh inner = box_mesh({0.5, 0.5, 0.5});
  for (auto& triangle : inner.triangles) std::swap(triangle[0], triangle[1]);
  CHECK(check_mesh(merged(box_mesh({1, 1, 1}), inner)).empty());
}

TEST_CASE("missing_triangle_gives_three_open_edges_at_its_place") {
  Mesh mesh = octahedron_mesh();
  mesh.triangles.erase(mesh.triangles.begin());  // x, y, z > 0
  const auto problems = check_mesh(mesh);
  const MeshProblem* open = find_problem(problems, "open_edge");
  REQUIRE(open != nullptr);
  CHECK(open->count == 3);
  CHECK(open->place.minCoeff() >= 0);  // middle of an edge of the missing triangle
  CHECK(open->place.sum() == doctest::Approx(1));
  CHECK(contains(open->message, "3 edge(s)"));
  CHECK(contains(open->message, "hint:"));
}

TEST_CASE("turned_triangle_gives_mismatched_winding") {
  Mesh mesh = octahedron_mesh();
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  const auto problems = check_mesh(mesh);
  const MeshProblem* mismatched = find_problem(problems, "mismatched_winding");
  REQUIRE(mismatched != nullptr);
  CHECK(mismatched->count == 3);
  CHECK(problems.size() == 1);
}

TEST_CASE("edge_of_four_triangles_is_overused") {
  // Two octahedra that share the edge from (1, 0, 0) to (0, 0, 1).
  Mesh mesh = octahedron_mesh();
  const Mesh twin = moved(mesh, Eigen::Quaterniond::Identity(), {1, 0, 1});
  mesh = merged(mesh, twin);
  for (auto& triangle : mesh.triangles) {
    for (int& index : triangle) {
      if (index == 6 + 1) index = 4;  // twin's (-1,0,0) corner lies at (0, 0, 1)
      if (index == 6 + 5) index = 0;  // twin's (0,0,-1) corner lies at (1, 0, 0)
    }
  }
  const auto problems = check_mesh(mesh);
  const MeshProblem* overused = find_problem(problems, "overused_edge");
  REQUIRE(overused != nullptr);
  CHECK(overused->count == 1);
  CHECK((overused->place - Eigen::Vector3d(0.5, 0, 0.5)).norm() == 0);
}

TEST_CASE("inside_out_mesh_is_named_as_such") {
  Mesh mesh = box_mesh({1, 1, 1});
  for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  const auto problems = check_mesh(mesh);
  REQUIRE(problems.size() == 1);
  CHECK(problems[0].code == "inside_out");
}

TEST_CASE("flat_meshes_are_named_as_such") {
  const Eigen::Quaterniond tilt(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()));
  const Mesh square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const auto open_problems = check_mesh(moved(square, tilt, {5, 0, 0}));
  CHECK(find_problem(open_problems, "open_edge") != nullptr);
  CHECK(find_problem(open_problems, "flat") != nullptr);

  const auto closed_problems = check_mesh(moved(box_mesh({1, 1, 1e-7}), tilt, {0, 0, 0}));
  REQUIRE(closed_problems.size() == 1);
  CHECK(closed_problems[0].code == "flat");
}

TEST_CASE("closed_sheet_that_is_not_planar_is_flat_too") {
  // Covered from both sides with all vertices shared, its inner edge has four triangles.
  const Mesh sheet{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 1}},
                   {{0, 1, 2}, {0, 2, 3}, {2, 1, 0}, {3, 2, 0}}};
  const auto problems = check_mesh(sheet);
  // With a middle vertex of its own on each side only the rim is shared: closed, without volume.
  CHECK(find_problem(problems, "overused_edge") != nullptr);
  const Mesh pillow{
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 1}, {0.5, 0.5, 0}, {0.5, 0.5, 0}},
      {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}}};
  const auto pillow_problems = check_mesh(pillow);
  REQUIRE(pillow_problems.size() == 1);
  CHECK(pillow_problems[0].code == "flat");
}

TEST_CASE("nonfinite_bad_index_degenerate_and_empty_are_found") {
  Mesh mesh = box_mesh({1, 1, 1});
  mesh.vertices[3].y() = std::numeric_limits<double>::quiet_NaN();
  const auto nonfinite = check_mesh(mesh);
  REQUIRE(nonfinite.size() == 1);
  CHECK(nonfinite[0].code == "nonfinite");
  CHECK(nonfinite[0].count == 1);
  CHECK(nonfinite[0].place.x() == 0.5);

  mesh = box_mesh({1, 1, 1});
  mesh.triangles[5][1] = 8;
  CHECK(check_mesh(mesh).at(0).code == "bad_index");
  mesh.triangles[5][1] = -1;
  CHECK(check_mesh(mesh).at(0).code == "bad_index");

  mesh = box_mesh({1, 1, 1});
  mesh.triangles.push_back({2, 2, 3});
  const auto degenerate = check_mesh(mesh);
  REQUIRE(degenerate.size() == 1);
  CHECK(degenerate[0].code == "degenerate_triangle");
  CHECK((degenerate[0].place - mesh.vertices[2]).norm() == 0);

  CHECK(check_mesh({}).at(0).code == "no_triangles");
}

TEST_CASE("refusal_names_file_and_all_problems") {
  Mesh mesh = octahedron_mesh();
  mesh.triangles.erase(mesh.triangles.begin());
  mesh.triangles.push_back({2, 2, 3});
  try {
    require_solid(mesh, "pony.obj");
    FAIL("not refused");
  } catch (const MeshError& error) {
    const std::string text = error.what();
    CHECK(contains(text, "pony.obj"));
    CHECK(contains(text, "open_edge: 3"));
    CHECK(contains(text, "degenerate_triangle: 1"));
    CHECK(contains(text, "hint:"));
  }
  CHECK_NOTHROW(require_solid(octahedron_mesh(), "pony.obj"));
}

TEST_CASE("shipped_meshes_are_solids") {
  for (const char* name : {"fox", "torus", "knot"}) {
    CAPTURE(name);
    const std::string file = std::string(VERISIM_SOURCE_DIR "/stimuli/meshes/") + name + ".obj";
    const Mesh mesh = load_mesh(file);
    CHECK_NOTHROW(require_solid(mesh, file));
    CHECK(mesh.triangles.size() >= 500);
  }
}
