// SPDX-License-Identifier: MIT
// Surface samples stand for all of the surface, evenly, whatever its triangles.
#include "shape/surface_samples.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "sample_meshes.h"
#include "shape/extents.h"
#include "shape/load_mesh.h"
#include "shape/primitives.h"
#include "shape/sharp_features.h"

using namespace verisim::shape;

namespace {

Mesh fox_mesh() { return load_mesh(VERISIM_SOURCE_DIR "/stimuli/meshes/fox.obj"); }

struct Sums {
  double area = 0, length = 0;
  int faces = 0, edges = 0, corners = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();    // integral of position over the area
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();   // of its square
  Eigen::Vector3d outward = Eigen::Vector3d::Zero();  // of the normal
};

Sums sum(const std::vector<SurfaceSample>& samples) {
  Sums sums;
  for (const SurfaceSample& s : samples) {
    sums.area += s.area;
    sums.length += s.edge_length;
    sums.faces += s.area > 0;
    sums.edges += s.edge_length > 0;
    sums.corners += s.is_vertex;
    sums.first += s.area * s.position;
    sums.second += s.area * s.position * s.position.transpose();
    sums.outward += s.area * s.normal;
  }
  return sums;
}

double mesh_area(const Mesh& mesh) {
  double area = 0;
  for (const FaceShape& face : face_shapes(mesh)) area += face.area;
  return area;
}

double sharp_convex_length(const Mesh& mesh) {
  double length = 0;
  for (const MeshEdge& edge : mesh_edges(mesh, face_shapes(mesh))) {
    if (edge.is_sharp() && edge.is_convex) {
      length += (mesh.vertices[edge.vertices[0]] - mesh.vertices[edge.vertices[1]]).norm();
    }
  }
  return length;
}

// Each triangle in four at the middles of its edges; edges stay shared.
Mesh split_in_four(const Mesh& mesh) {
  Mesh fine{mesh.vertices, {}};
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int a, int b) {
    const auto [found, is_new] =
        middles.try_emplace(std::minmax(a, b), static_cast<int>(fine.vertices.size()));
    if (is_new) fine.vertices.push_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
    return found->second;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    for (const auto& triangle : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
      fine.triangles.push_back(triangle);
    }
  }
  return fine;
}

// The largest distance from a sample to the nearest of the same kind in the other set, both ways,
// and the largest difference of their weights.
struct SetDifference {
  double place = 0, weight = 0;
};

SetDifference difference(const std::vector<SurfaceSample>& one,
                         const std::vector<SurfaceSample>& other) {
  SetDifference worst;
  for (const auto& [from, to] : {std::pair(&one, &other), {&other, &one}}) {
    for (const SurfaceSample& s : *from) {
      double least = INFINITY, weight = 0;
      for (const SurfaceSample& t : *to) {
        const bool same_kind = (s.area > 0) == (t.area > 0) && s.is_vertex == t.is_vertex;
        const double distance = (s.position - t.position).norm() + (s.normal - t.normal).norm();
        if (!same_kind || distance >= least) continue;
        least = distance;
        weight = std::abs(s.area - t.area) + std::abs(s.edge_length - t.edge_length);
      }
      worst.place = std::max(worst.place, least);
      worst.weight = std::max(worst.weight, weight);
    }
  }
  return worst;
}

Mesh roof_mesh() {  // a bar of three sides, ridge along x, axes not those of its faces
  return {{{0, -1, 0}, {0, 1, 0}, {0, 0, 0.4}, {3, -1, 0}, {3, 1, 0}, {3, 0, 0.4}},
          {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}}};
}

}  // namespace

TEST_CASE("areas_and_lengths_sum_to_those_of_the_mesh") {
  std::mt19937 rng(1);
  const Mesh tilted = moved(box_mesh({1, 0.7, 0.3}), random_rotation(rng), {0.3, 2, -1});
  for (const Mesh& mesh : {fox_mesh(), tilted, roof_mesh(), torus_mesh(1, 0.3, 40, 20)}) {
    const double extent = smallest_extent(mesh);
    for (double spacing : {extent / 3, extent / 11, 4 * extent}) {
      const Sums sums = sum(sample_surface(mesh, spacing));
      CHECK(sums.area == doctest::Approx(mesh_area(mesh)).epsilon(1e-11));
      CHECK(sums.length == doctest::Approx(sharp_convex_length(mesh)).epsilon(1e-11));
    }
  }
}

TEST_CASE("flat_faces_with_edges_all_round_are_framed_and_curved_ones_are_not") {
  const auto count_framed = [](const Mesh& mesh, double spacing) {
    const std::vector<SurfaceSample> samples = sample_surface(mesh, spacing);
    return std::count_if(samples.begin(), samples.end(),
                         [](const SurfaceSample& s) { return s.is_framed; });
  };
  CHECK(count_framed(box_mesh({1, 1, 1}), 0.25) == 6 * 16);
  CHECK(count_framed(box_mesh({1, 1, 1}), 0.4) == 0);  // 2.5 squares wide
  CHECK(count_framed(torus_mesh(1, 0.3, 40, 20), 0.05) == 0);
  // A ridge of 4.6 degrees: an edge between its wide slopes, and none once they are narrow.
  const Mesh ridge{{{0, -1, 0}, {0, 1, 0}, {0, 0, 0.04}, {3, -1, 0}, {3, 1, 0}, {3, 0, 0.04}},
                   roof_mesh().triangles};
  const double edges_below = 2 * (3 + 2), rafters = 4 * std::hypot(1, 0.04);
  CHECK(sum(sample_surface(ridge, 0.2)).length ==
        doctest::Approx(edges_below + rafters + 3).epsilon(1e-11));
  CHECK(sum(sample_surface(ridge, 0.9)).length ==
        doctest::Approx(edges_below + rafters).epsilon(1e-11));
}

TEST_CASE("a_cube_has_the_samples_of_its_lattice_and_all_its_symmetries") {
  const std::vector<SurfaceSample> samples = sample_surface(box_mesh({1, 1, 1}), 0.25);
  const Sums sums = sum(samples);
  CHECK(sums.faces == 6 * 16);
  CHECK(sums.edges == 12 * 4);
  CHECK(sums.corners == 8);
  CHECK(sums.length == doctest::Approx(12));
  for (const SurfaceSample& s : samples) {
    if (s.area > 0) CHECK(s.area == doctest::Approx(1.0 / 16));
    if (s.edge_length > 0) CHECK(s.edge_length == doctest::Approx(0.25));
  }
  // A mirror and a quarter turn generate the rest.
  auto mirrored = samples, turned = samples;
  for (SurfaceSample& s : mirrored) s.position.x() *= -1, s.normal.x() *= -1;
  for (SurfaceSample& s : turned) {
    s.position = Eigen::Vector3d(s.position.y(), s.position.z(), s.position.x());
    s.normal = Eigen::Vector3d(s.normal.y(), s.normal.z(), s.normal.x());
  }
  CHECK(difference(samples, mirrored).place < 1e-14);
  CHECK(difference(samples, mirrored).weight < 1e-14);
  CHECK(difference(samples, turned).place < 1e-14);
}

TEST_CASE("no_place_on_the_surface_is_far_from_a_face_sample") {
  std::mt19937 rng(2);
  for (const Mesh& mesh : {fox_mesh(), sphere_mesh(0.5, 4), roof_mesh(),
                           moved(box_mesh({1, 0.6, 0.4}), random_rotation(rng), {0, 0, 0})}) {
    const double spacing = smallest_extent(mesh) / 5;
    const std::vector<SurfaceSample> samples = sample_surface(mesh, spacing);
    double largest_hole = 0;
    std::uniform_int_distribution<std::size_t> any(0, mesh.triangles.size() - 1);
    std::uniform_real_distribution<double> share(0, 1);
    for (int n = 0; n < 500; ++n) {
      const auto& [a, b, c] = mesh.triangles[any(rng)];
      const double r = std::sqrt(share(rng)), t = share(rng);
      const Eigen::Vector3d place =
          (1 - r) * mesh.vertices[a] + r * (1 - t) * mesh.vertices[b] + r * t * mesh.vertices[c];
      double least = INFINITY;
      for (const SurfaceSample& s : samples) {
        if (s.area > 0) least = std::min(least, (s.position - place).norm());
      }
      largest_hole = std::max(largest_hole, least);
    }
    // Half the diagonal of a cell, times sqrt(3) where the surface is steepest against it: 1.22.
    CHECK(largest_hole < 1.3 * spacing);  // measured 0.26 (fox) to 1.2 (roof)
  }
}

TEST_CASE("fine_meshes_get_no_more_samples_than_their_area_asks_for") {
  for (int subdivisions : {3, 4, 5}) {
    const Mesh sphere = sphere_mesh(1, subdivisions);
    const Sums sums = sum(sample_surface(sphere, 0.25));
    CAPTURE(subdivisions);
    const double wanted = sums.area / (0.25 * 0.25);
    CHECK(sums.faces < 1.4 * wanted);  // measured 1.07
    CHECK(sums.faces > 0.8 * wanted);
    CHECK(sums.edges == 0);
    CHECK(sums.corners == 0);
  }
}

TEST_CASE("a_rough_fine_mesh_does_not_get_a_sample_per_triangle") {
  Mesh rough = sphere_mesh(1, 5);  // 20480 triangles with edges of 0.03
  std::mt19937 rng(4);
  std::uniform_real_distribution<double> height(0.997, 1.003);
  for (Eigen::Vector3d& vertex : rough.vertices) vertex *= height(rng);
  const std::vector<SurfaceSample> samples = sample_surface(rough, 0.25);
  const Sums sums = sum(samples);
  CHECK(sums.area == doctest::Approx(mesh_area(rough)).epsilon(1e-11));
  CHECK(samples.size() < 1200);  // measured 919; the smooth sphere has 216
}

TEST_CASE("the_order_of_triangles_and_of_their_corners_does_not_matter") {
  const Mesh fox = fox_mesh();
  Mesh shuffled = fox;
  std::mt19937 rng(6);
  std::shuffle(shuffled.triangles.begin(), shuffled.triangles.end(), rng);
  for (auto& triangle : shuffled.triangles) {
    std::rotate(triangle.begin(), triangle.begin() + rng() % 3, triangle.end());
  }
  const double spacing = smallest_extent(fox) / 6;
  const auto samples = sample_surface(fox, spacing), again = sample_surface(shuffled, spacing);
  CHECK(samples.size() == again.size());
  CHECK(difference(samples, again).place < 1e-9);  // measured 6e-16
  CHECK(difference(samples, again).weight < 1e-12);
}

TEST_CASE("splitting_the_triangles_of_plane_faces_changes_no_sample") {
  std::mt19937 rng(8);
  const Mesh box = moved(box_mesh({1, 0.7, 0.3}), random_rotation(rng), {0.1, 0.2, 0.3});
  const auto samples = sample_surface(box, 0.1);
  const auto fine = sample_surface(split_in_four(split_in_four(box)), 0.1);
  CHECK(samples.size() == fine.size());
  CHECK(difference(samples, fine).place < 1e-9);
  CHECK(difference(samples, fine).weight < 1e-12);
}

TEST_CASE("splitting_the_triangles_of_the_fox_keeps_the_moments") {
  const Mesh fox = fox_mesh();
  const double spacing = smallest_extent(fox) / 6;
  const Sums whole = sum(sample_surface(fox, spacing));
  const Sums split = sum(sample_surface(split_in_four(fox), spacing));
  CHECK((whole.first - split.first).norm() < 1e-9 * whole.area * spacing);  // measured 1e-15
  CHECK((whole.second - split.second).norm() < 1e-9 * whole.second.norm());
}

TEST_CASE("moments_converge_with_the_spacing") {
  // Ball: the integral of z^4 is 4 pi / 5; the mesh itself misses 1e-3 of it.
  const Mesh sphere = sphere_mesh(1, 5);
  std::vector<double> errors;
  for (double spacing : {0.5, 0.25, 0.125}) {
    double fourth = 0;
    for (const SurfaceSample& s : sample_surface(sphere, spacing)) {
      fourth += s.area * std::pow(s.position.z(), 4);
    }
    errors.push_back(std::abs(fourth / (0.8 * std::numbers::pi) - 1));
  }
  CHECK(errors[0] < 5e-2);  // measured 2.7e-2
  CHECK(errors[1] < 2e-3);  // measured 2.0e-4
  CHECK(errors[2] < 2e-3);  // measured 1.6e-3, the mesh itself
  // A box: first moments of its faces are exact whatever the spacing.
  const Mesh box =
      moved(box_mesh({1, 2, 3}), Eigen::Quaterniond(0.9, 0.1, 0.3, 0.2).normalized(), {1, 2, 3});
  for (double spacing : {2.0, 0.3}) {
    const Sums sums = sum(sample_surface(box, spacing));
    CHECK((sums.first / sums.area - Eigen::Vector3d(1, 2, 3)).norm() < 1e-12);
    CHECK(sums.outward.norm() < 1e-12 * sums.area);
  }
}

TEST_CASE("pits_and_grooves_have_no_edge_or_corner_samples") {
  // A box with a box pressed into its top, as a closed mesh: 8 + 8 corners, a rim, 4 pit corners.
  const Mesh pit{{{-2, -2, 0},
                  {2, -2, 0},
                  {2, 2, 0},
                  {-2, 2, 0},
                  {-2, -2, 2},
                  {2, -2, 2},
                  {2, 2, 2},
                  {-2, 2, 2},
                  {-1, -1, 2},
                  {1, -1, 2},
                  {1, 1, 2},
                  {-1, 1, 2},
                  {-1, -1, 1},
                  {1, -1, 1},
                  {1, 1, 1},
                  {-1, 1, 1}},
                 {{0, 2, 1},   {0, 3, 2},    {0, 1, 5},    {0, 5, 4},   {1, 2, 6},    {1, 6, 5},
                  {2, 3, 7},   {2, 7, 6},    {3, 0, 4},    {3, 4, 7},   {4, 5, 9},    {4, 9, 8},
                  {5, 6, 10},  {5, 10, 9},   {6, 7, 11},   {6, 11, 10}, {7, 4, 8},    {7, 8, 11},
                  {8, 9, 13},  {8, 13, 12},  {9, 10, 14},  {9, 14, 13}, {10, 11, 15}, {10, 15, 14},
                  {11, 8, 12}, {11, 12, 15}, {12, 13, 14}, {12, 14, 15}}};
  const Sums sums = sum(sample_surface(pit, 0.5));
  CHECK(sums.area == doctest::Approx(2 * 16 + 4 * 8 + 4 * 2));
  CHECK(sums.length == doctest::Approx(12 * 4 - 4 * 2 + 4 * 2));  // box, its height 2, and the rim
  CHECK(sums.corners == 8);
}

TEST_CASE("no_sample_mixes_the_two_sides_of_a_ridge") {
  // Three cells across: the ridge runs along the middle of one, and both sides face upwards.
  const Mesh roof = roof_mesh();
  const std::vector<FaceShape> faces = face_shapes(roof);
  double worst = 0;
  for (const SurfaceSample& s : sample_surface(roof, 0.7)) {
    if (!(s.area > 0)) continue;
    double least = INFINITY;
    for (const FaceShape& face : faces) least = std::min(least, (face.normal - s.normal).norm());
    worst = std::max(worst, least);
  }
  CHECK(worst < 1e-14);  // measured 2e-16
}

TEST_CASE("samples_lie_on_the_mesh_and_face_outwards") {
  const Mesh sphere = sphere_mesh(1, 5);
  double worst = 0, least_outward = 1;
  for (const SurfaceSample& s : sample_surface(sphere, 0.3)) {
    worst = std::max(worst, std::abs(s.position.norm() - 1));
    least_outward = std::min(least_outward, s.normal.dot(s.position));
  }
  CHECK(worst < 4e-4);  // measured 2.8e-4: the facets lie below the sphere
  CHECK(least_outward > 0.99);
}

TEST_CASE("sample_spacings_without_sense_are_refused") {
  for (double spacing : {0.0, -1.0, double(NAN), 1e-4}) {
    CHECK_THROWS_WITH_AS(sample_surface(box_mesh({1, 1, 1}), spacing), doctest::Contains("hint:"),
                         MeshError);
  }
}
