// SPDX-License-Identifier: MIT
// Particle fills: exact counts, convergence of volume, touching faces, and refusals.
#include "shape/fill_particles.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>

#include "sample_meshes.h"
#include "shape/extents.h"
#include "shape/load_mesh.h"
#include "shape/mass_properties.h"
#include "shape/primitives.h"

using namespace verisim::shape;

namespace {

double cell_volume(const ParticleFill& fill) {
  return static_cast<double>(fill.centers.size()) * std::pow(2 * fill.radius, 3);
}

// Root mean square over random rotations of (cells' volume / mesh volume - 1), with cells_across
// cells along the longest edge of the unrotated mesh.
double rms_volume_error(const Mesh& mesh, int cells_across, int num_rotations) {
  std::mt19937 rng(7);
  const double spacing = bounding_box(mesh).sizes().maxCoeff() / cells_across;
  const double volume = signed_volume(mesh);
  double sum = 0;
  for (int i = 0; i < num_rotations; ++i) {
    const Mesh turned = moved(mesh, random_rotation(rng), Eigen::Vector3d::Zero());
    sum += std::pow(cell_volume(fill_mesh(turned, spacing)) / volume - 1, 2);
  }
  return std::sqrt(sum / num_rotations);
}

template <typename Function>
std::string refusal(Function function) {
  try {
    function();
  } catch (const FillError& error) {
    return error.what();
  }
  return "not refused";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("cube_mesh_with_rays_on_its_diagonals_fills_completely") {
  // The rays of the columns i == j pass exactly through the diagonal edge of top and bottom.
  const ParticleFill fill = fill_mesh(box_mesh({1, 1, 1}), 0.1);
  CHECK(fill.centers.size() == 1000);
  CHECK(fill.radius == 0.05);
  CHECK(fill.num_odd_columns == 0);
  CHECK(fill.num_overlapping_cells == 0);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& center : fill.centers) {
    sum += center;
    CHECK(center.cwiseAbs().maxCoeff() < 0.45 + 1e-12);
  }
  CHECK(sum.norm() < 1e-11);  // measured 7e-14
}

TEST_CASE("octahedron_with_rays_through_vertices_and_edges_fills_exactly") {
  // 7 cells across: one ray runs through both tips, the rays of row and column 4 along the edges.
  // |x| + |y| + |z| < 1 at multiples of 0.3 leaves the 63 points with |i| + |j| + |k| <= 3.
  const ParticleFill fill = fill_mesh(octahedron_mesh(), 0.3);
  CHECK(fill.centers.size() == 63);
  CHECK(fill.num_odd_columns == 0);
  for (const Eigen::Vector3d& center : fill.centers) CHECK(center.cwiseAbs().sum() < 0.9 + 1e-12);
}

TEST_CASE("every_cell_of_a_torus_is_decided_as_by_its_equation") {
  const double ring = 0.35, tube = 0.15, spacing = 0.03;
  const ParticleFill fill = fill_mesh(torus_mesh(ring, tube, 400, 200), spacing);
  // Grid of 34 x 34 x 10 cells centred on 0, against the smooth torus; the facets lie at most
  // ring + tube times (1 - cos(pi/400)) = 1.5e-5 below it.
  std::int64_t num_inside = 0;
  for (int i = 0; i < 34; ++i) {
    for (int j = 0; j < 34; ++j) {
      for (int k = 0; k < 10; ++k) {
        const Eigen::Vector3d p = spacing * Eigen::Vector3d(i - 16.5, j - 16.5, k - 4.5);
        num_inside += std::hypot(p.head<2>().norm() - ring, p.z()) < tube - 2e-5;
      }
    }
  }
  CHECK(static_cast<std::int64_t>(fill.centers.size()) == num_inside);
}

TEST_CASE("cell_volume_converges_to_mesh_volume") {
  const Mesh sphere = sphere_mesh(0.5, 4);
  const Mesh torus = torus_mesh(0.35, 0.15, 48, 24);
  const Mesh box = box_mesh({1, 0.6, 0.25});
  // Bounds lie about a third above the measured errors. The ball's are the largest: the grid is
  // centred on it whatever its rotation, and symmetry lets the errors of many cells agree.
  struct Bounds {
    int cells_across;
    double sphere, torus, box;
  };
  for (const Bounds& bounds : {Bounds{8, 0.062, 0.065, 0.059},          // .0467 .0486 .0440
                               Bounds{16, 0.022, 0.026, 0.014},         // .0168 .0197 .0102
                               Bounds{32, 0.0106, 0.0056, 0.0025},      // .0079 .0042 .0019
                               Bounds{64, 0.0018, 0.0009, 0.00045}}) {  // .0013 .0007 .0003
    CAPTURE(bounds.cells_across);
    CHECK(rms_volume_error(sphere, bounds.cells_across, 20) < bounds.sphere);
    CHECK(rms_volume_error(torus, bounds.cells_across, 20) < bounds.torus);
    CHECK(rms_volume_error(box, bounds.cells_across, 20) < bounds.box);
  }
}

TEST_CASE("hollow_body_stays_hollow") {
  Mesh inner = box_mesh({0.5, 0.5, 0.5});
  for (auto& triangle : inner.triangles) std::swap(triangle[0], triangle[1]);
  const ParticleFill fill = fill_mesh(merged(box_mesh({1, 1, 1}), inner), 0.125);
  CHECK(fill.centers.size() == 512 - 64);
  CHECK(fill.num_overlapping_cells == 0);
}

TEST_CASE("overlapping_parts_are_counted") {
  const Mesh box = box_mesh({1, 1, 1});
  const Mesh twin = moved(box, Eigen::Quaterniond::Identity(), {0.5, 0.5, 0.5});
  // The parts share a cube of 0.5 m: 4^3 cells of 0.125 m, inside twice.
  CHECK(fill_mesh(merged(box, twin), 0.125).num_overlapping_cells == 64);
}

TEST_CASE("open_mesh_reports_odd_columns_and_fills_nothing_above_the_hole") {
  Mesh mesh = box_mesh({1, 1, 1});
  mesh.triangles.erase(mesh.triangles.begin() + 2);  // half of the top
  const ParticleFill fill = fill_mesh(mesh, 0.1);
  CHECK(fill.num_odd_columns >= 45);
  CHECK(fill.num_odd_columns <= 55);
  CHECK(static_cast<std::int64_t>(fill.centers.size()) == 10 * (100 - fill.num_odd_columns));
}

TEST_CASE("fill_moves_with_the_mesh") {
  const Mesh torus = torus_mesh(0.35, 0.15, 24, 12);
  const Eigen::Vector3d shift(8, -16, 4);  // powers of two: the shift itself is nearly exact
  const ParticleFill here = fill_mesh(torus, 0.037);
  const ParticleFill there = fill_mesh(moved(torus, Eigen::Quaterniond::Identity(), shift), 0.037);
  REQUIRE(here.centers.size() == there.centers.size());
  for (std::size_t i = 0; i < here.centers.size(); ++i) {
    CHECK((here.centers[i] + shift - there.centers[i]).norm() < 1e-13);
  }
}

TEST_CASE("coarse_particles_catch_every_part_of_the_fox") {
  const Mesh fox = load_mesh(VERISIM_SOURCE_DIR "/stimuli/meshes/fox.obj");
  const Eigen::AlignedBox3d box = bounding_box(fox);
  const ParticleFill fill = fill_mesh(fox, box.sizes().x() / 12);
  CHECK(fill.num_odd_columns == 0);
  CHECK(fill.num_overlapping_cells == 0);
  const auto count_in = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    const Eigen::AlignedBox3d region(low, high);
    return std::count_if(fill.centers.begin(), fill.centers.end(),
                         [&](const Eigen::Vector3d& c) { return region.contains(c); });
  };
  for (double side : {-1.0, 1.0}) {
    CAPTURE(side);
    const double low = std::min(0.0, side), high = std::max(0.0, side);
    CHECK(count_in({0.1, low, 0.0}, {0.3, high, 0.2}) >= 2);     // front leg
    CHECK(count_in({-0.3, low, 0.0}, {-0.1, high, 0.2}) >= 2);   // hind leg
    CHECK(count_in({0.2, low, 0.66}, {0.35, high, 0.84}) >= 1);  // ear
  }
  CHECK(count_in({0.4, -1, 0.5}, {0.54, 1, 0.65}) >= 1);   // snout
  CHECK(count_in({-0.6, -1, 0.2}, {-0.3, 1, 0.45}) >= 4);  // tail
}

TEST_CASE("shipped_meshes_fill_without_odd_columns_or_overlaps") {
  for (const char* name : {"fox", "torus", "knot"}) {
    CAPTURE(name);
    const Mesh mesh = load_mesh(std::string(VERISIM_SOURCE_DIR "/stimuli/meshes/") + name + ".obj");
    const ParticleFill fill = fill_mesh(mesh, 0.02);
    CHECK(fill.num_odd_columns == 0);
    CHECK(fill.num_overlapping_cells == 0);
    CHECK(std::abs(cell_volume(fill) / signed_volume(mesh) - 1) < 0.02);
  }
}

TEST_CASE("box_particles_touch_all_faces") {
  for (const auto& [edges, spacing] : {std::pair(Eigen::Vector3d(1, 1, 1), 0.25),
                                       {Eigen::Vector3d(0.3, 0.5, 1.1), 0.1},
                                       {Eigen::Vector3d(1, 0.35, 0.35), 0.1},
                                       {Eigen::Vector3d(1, 1, 0.05), 0.1},
                                       {Eigen::Vector3d(1.4, 1, 1), 1.0},
                                       {Eigen::Vector3d(1, 1, 1), 5.0}}) {
    CAPTURE(spacing);
    const ParticleFill fill = fill_box(edges, spacing);
    Eigen::AlignedBox3d reach;
    for (const Eigen::Vector3d& center : fill.centers) reach.extend(center);
    const Eigen::Vector3d outer = reach.max() + Eigen::Vector3d::Constant(fill.radius);
    CHECK((outer - edges / 2).norm() < 1e-15);  // measured 1.1e-16
    CHECK((reach.max() + reach.min()).norm() < 1e-15);
  }
  CHECK(fill_box({1, 1, 1}, 0.25).centers.size() == 64);
  CHECK(fill_box({1, 1, 1}, 5).centers.size() == 1);
  CHECK(fill_box({0.2, 0.2, 0.1}, 0.05).centers.size() == 32);
  CHECK(fill_box({1, 1, 0.05}, 0.1).centers.size() == 400);  // as thin as one particle
  CHECK(fill_box({1.4, 1, 1}, 1).centers.size() == 2);
}

TEST_CASE("ball_is_one_particle") {
  const ParticleFill fill = fill_sphere(0.3);
  REQUIRE(fill.centers.size() == 1);
  CHECK(fill.centers[0].norm() == 0);
  CHECK(fill.radius == 0.3);
}

TEST_CASE("unusable_particle_sizes_are_refused") {
  const Mesh box = box_mesh({1, 1, 1});
  for (double spacing : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    CAPTURE(spacing);
    CHECK(contains(refusal([&] { fill_mesh(box, spacing); }), "not a positive number"));
    CHECK(contains(refusal([&] { fill_box({1, 1, 1}, spacing); }), "not a positive number"));
  }
}

TEST_CASE("too_many_particles_are_refused_before_they_are_made") {
  const Mesh box = box_mesh({1, 1, 1});
  for (double spacing : {1e-3, 1e-9, 1e-300}) {
    CAPTURE(spacing);
    CHECK(contains(refusal([&] { fill_mesh(box, spacing); }), "hint: use larger particles"));
    CHECK(contains(refusal([&] { fill_box({1, 1, 1}, spacing); }), "hint: use larger particles"));
  }
  CHECK(contains(refusal([&] { fill_mesh(box, 0.1, 999); }), "needs 1000 particles"));
  CHECK(contains(refusal([&] { fill_box({1, 1, 1}, 0.1, 999); }), "needs 1000 particles"));
  CHECK(fill_mesh(box, 0.1, 1000).centers.size() == 1000);
}

TEST_CASE("mesh_that_no_cell_centre_lies_in_is_refused") {
  // The grid's only cell centre lies in the hole of the torus.
  const Mesh torus = torus_mesh(0.35, 0.15, 24, 12);
  CHECK(contains(refusal([&] { fill_mesh(torus, 2); }), "without particles"));
}
