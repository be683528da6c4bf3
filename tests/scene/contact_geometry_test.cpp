// SPDX-License-Identifier: MIT
// Mesh bodies bring a distance field and weighted points to their contacts.
#include "scene/contact_geometry.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "shape/extents.h"
#include "shape/load_mesh.h"
#include "shape/mass_properties.h"
#include "shape/mesh_error.h"
#include "shape/primitives.h"
#include "shape/surface_samples.h"

using namespace verisim;
using scene::default_sample_spacing;
using scene::make_mesh_surface;

namespace {

shape::Mesh fox_from_com() {
  shape::Mesh fox = shape::load_mesh(VERISIM_SOURCE_DIR "/stimuli/meshes/fox.obj");
  const Eigen::Vector3d center = shape::mesh_mass_properties(fox).center_of_mass;
  for (Eigen::Vector3d& vertex : fox.vertices) vertex -= center;
  return fox;
}

double total_weight(const dem::MeshSurface& surface) {
  double total = 0;
  for (const dem::SurfacePoint& point : surface.points) total += point.weight;
  return total;
}

}  // namespace

TEST_CASE("weights_of_a_cube_count_edges_and_corners_in_quarters_and_faces_where_they_are_small") {
  // Edge 0.2, reference 0.05: faces 6 x 16, edges 12 x 4, corners 8 x 1.
  const dem::MeshSurface coarse = make_mesh_surface(shape::box_mesh({0.2, 0.2, 0.2}), 0.1);
  CHECK(total_weight(coarse) == doctest::Approx(96 + 48 + 8).epsilon(1e-11));
  for (double spacing : {0.05, 0.023, 0.01}) {
    const dem::MeshSurface cube = make_mesh_surface(shape::box_mesh({0.2, 0.2, 0.2}), spacing);
    CHECK(cube.reference_length == doctest::Approx(0.05));
    CHECK(total_weight(cube) == doctest::Approx(48 + 8).epsilon(1e-11));
    CHECK(cube.reach == doctest::Approx(0.1 * std::sqrt(3.0)));
  }
}

TEST_CASE("points_of_the_fox_lie_on_its_distance_field_in_blocks_that_hold_them") {
  const shape::Mesh fox = fox_from_com();
  const dem::MeshSurface surface = make_mesh_surface(fox, default_sample_spacing(fox));
  CHECK(surface.points.size() > 1000);
  CHECK(surface.points.size() <= 2000);
  double squares = 0, worst = 0;
  for (const dem::SurfacePoint& point : surface.points) {
    const double distance = std::abs(dem::distance_at(surface.field, point.position_b).value);
    squares += distance * distance;
    worst = std::max(worst, distance);
    REQUIRE(point.weight > 0);
    REQUIRE(point.position_b.norm() <= surface.reach * (1 + 1e-12));
  }
  const double rms = std::sqrt(squares / static_cast<double>(surface.points.size()));
  CHECK(rms < 0.15 * surface.field.spacing);  // measured 1.4e-3 m = 0.09 spacings
  CHECK(worst < surface.field.spacing);       // measured 9.6e-3 m = 0.6, at the ears' edges
  int next = 0;
  double mean_radius = 0;
  int num_smallest = 0;
  for (std::size_t b = 0; b < surface.blocks.size(); ++b) {
    const dem::SurfaceBlock& block = surface.blocks[b];
    REQUIRE(block.first == next);
    REQUIRE(block.count >= 1);
    for (int n = block.first; n < block.first + block.count; ++n) {
      REQUIRE((surface.points[n].position_b - block.centre_b).norm() <= block.radius);
    }
    if (block.next > static_cast<int>(b) + 1) continue;  // its parts follow
    REQUIRE(block.count <= 32);
    ++num_smallest;
    next += block.count;
    mean_radius += block.radius;
  }
  mean_radius /= num_smallest;
  CHECK(surface.blocks.front().next == static_cast<int>(surface.blocks.size()));
  CHECK(next == static_cast<int>(surface.points.size()));
  CHECK(num_smallest == static_cast<int>(surface.points.size() + 31) / 32);
  CHECK(mean_radius < 0.3 * surface.reach);  // measured 0.16
}

TEST_CASE("the_default_spacing_is_a_twelfth_of_the_extent_or_what_2000_points_allow") {
  const shape::Mesh cube = shape::box_mesh({1, 1, 1});
  CHECK(default_sample_spacing(cube) == doctest::Approx(1.0 / 12));
  const shape::Mesh plate = shape::box_mesh({1, 0.8, 0.01});
  const std::size_t count = shape::sample_surface(plate, default_sample_spacing(plate)).size();
  CHECK(count <= 2000);
  CHECK(count > 1000);
}

TEST_CASE("bodies_without_an_inside_have_no_contact_geometry") {
  shape::Mesh open = shape::box_mesh({1, 1, 1});
  open.triangles.pop_back();
  CHECK_THROWS_AS(make_mesh_surface(open, 0.1), shape::MeshError);
}
