// SPDX-License-Identifier: MIT
// Volume, centre of mass and inertia against closed forms, and their invariances.
#include "shape/mass_properties.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "sample_meshes.h"
#include "shape/primitives.h"

using namespace verisim::shape;

namespace {

double relative_difference(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return (a - b).norm() / b.norm();
}

}  // namespace

TEST_CASE("box_mesh_has_the_closed_form_of_the_box") {
  const Eigen::Vector3d edges(0.3, 0.5, 1.1);
  const MassProperties mesh = mesh_mass_properties(box_mesh(edges));
  const MassProperties box = box_mass_properties(edges);
  CHECK(box.volume == doctest::Approx(0.165).epsilon(1e-14));
  CHECK(box.inertia(0, 0) == doctest::Approx(0.165 * (0.25 + 1.21) / 12).epsilon(1e-14));
  CHECK(std::abs(mesh.volume / box.volume - 1) < 1e-14);          // measured 0
  CHECK(mesh.center_of_mass.norm() < 1e-15);                      // measured 0
  CHECK(relative_difference(mesh.inertia, box.inertia) < 1e-14);  // measured 1.5e-16
}

TEST_CASE("tetrahedron_has_its_textbook_inertia") {
  // Corner at 0 and edges a, b, c along the axes: V = abc/6, centre (a, b, c)/4,
  // I_xx = V (3/80)(b^2 + c^2), I_xy = V ab/80 about the centre.
  const Mesh tetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}},
                         {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  const MassProperties found = mesh_mass_properties(tetrahedron);
  Eigen::Matrix3d expected;
  expected << 3 * (4 + 9), 2, 3, 2, 3 * (1 + 9), 6, 3, 6, 3 * (1 + 4);
  expected /= 80;
  CHECK(found.volume == doctest::Approx(1).epsilon(1e-14));
  CHECK((found.center_of_mass - Eigen::Vector3d(0.25, 0.5, 0.75)).norm() < 1e-15);
  CHECK(relative_difference(found.inertia, expected) < 1e-14);  // measured 2e-16
}

TEST_CASE("inertia_of_two_boxes_adds_by_the_parallel_axis_theorem") {
  // Of unlike boxes the mean vertex is not the centre of mass.
  const Eigen::Vector3d edges_a(1, 2, 3), edges_b(0.2, 0.3, 0.4), shift(2, 1, -1);
  const Mesh both =
      merged(box_mesh(edges_a), moved(box_mesh(edges_b), Eigen::Quaterniond::Identity(), shift));
  const MassProperties a = box_mass_properties(edges_a), b = box_mass_properties(edges_b);
  const double reduced = a.volume * b.volume / (a.volume + b.volume);
  const Eigen::Matrix3d expected =
      a.inertia + b.inertia +
      reduced * (shift.squaredNorm() * Eigen::Matrix3d::Identity() - shift * shift.transpose());
  const MassProperties found = mesh_mass_properties(both);
  CHECK((found.center_of_mass - shift * b.volume / found.volume).norm() < 1e-15);
  CHECK(relative_difference(found.inertia, expected) < 1e-14);  // measured 4e-16
}

TEST_CASE("sphere_mesh_converges_to_the_ball_at_second_order") {
  const double radius = 0.7;
  const MassProperties ball = sphere_mass_properties(radius);
  std::vector<double> volume_errors, inertia_errors;
  for (int subdivisions = 2; subdivisions <= 5; ++subdivisions) {
    const MassProperties mesh = mesh_mass_properties(sphere_mesh(radius, subdivisions));
    volume_errors.push_back(1 - mesh.volume / ball.volume);
    inertia_errors.push_back(relative_difference(mesh.inertia, ball.inertia));
  }
  // Halving the triangles divides the error by 4; measured 3.97 to 4.00.
  for (std::size_t i = 1; i < volume_errors.size(); ++i) {
    CHECK(volume_errors[i - 1] / volume_errors[i] == doctest::Approx(4).epsilon(0.03));
    CHECK(inertia_errors[i - 1] / inertia_errors[i] == doctest::Approx(4).epsilon(0.03));
  }
  CHECK(volume_errors.back() < 6e-4);   // measured 5.4e-4 at 20480 triangles
  CHECK(inertia_errors.back() < 1e-3);  // measured 9.0e-4
}

TEST_CASE("torus_mesh_converges_to_the_closed_form_of_the_torus") {
  const double ring = 0.35, tube = 0.15;
  const double volume = 2 * std::pow(std::numbers::pi, 2) * ring * tube * tube;
  const double about_axis = volume * (ring * ring + 0.75 * tube * tube);
  const double across = volume * (0.5 * ring * ring + 0.625 * tube * tube);
  Eigen::Matrix3d inertia = Eigen::Vector3d(across, across, about_axis).asDiagonal();
  double previous_volume_error = 0, previous_inertia_error = 0;
  for (int size : {24, 48, 96}) {
    const MassProperties mesh = mesh_mass_properties(torus_mesh(ring, tube, size, size));
    const double volume_error = std::abs(mesh.volume / volume - 1);
    const double inertia_error = relative_difference(mesh.inertia, inertia);
    if (size > 24) {  // measured ratios 3.97 to 4.00
      CHECK(previous_volume_error / volume_error == doctest::Approx(4).epsilon(0.03));
      CHECK(previous_inertia_error / inertia_error == doctest::Approx(4).epsilon(0.03));
    }
    previous_volume_error = volume_error;
    previous_inertia_error = inertia_error;
  }
  CHECK(previous_volume_error < 2e-3);  // measured 1.4e-3 at 18432 triangles
  CHECK(previous_inertia_error < 4e-3);
}

TEST_CASE("rotation_turns_inertia_and_translation_leaves_it") {
  std::mt19937 rng(1);
  const Mesh torus = torus_mesh(0.35, 0.15, 20, 12);
  const MassProperties still = mesh_mass_properties(torus);
  for (int i = 0; i < 10; ++i) {
    const Eigen::Quaterniond q = random_rotation(rng);
    const Eigen::Matrix3d turn = q.toRotationMatrix();
    const Eigen::Vector3d shift(3, -20, 7);
    const MassProperties found = mesh_mass_properties(moved(torus, q, shift));
    CHECK(std::abs(found.volume / still.volume - 1) < 1e-13);  // measured 1.1e-14
    CHECK((found.center_of_mass - shift - turn * still.center_of_mass).norm() < 1e-13);
    CHECK(relative_difference(found.inertia, turn * still.inertia * turn.transpose()) < 1e-13);
  }
}

TEST_CASE("mesh_far_from_the_origin_loses_no_more_than_its_coordinates_do") {
  // At 10 km coordinates are rounded to 1.8e-12 m, 6e-12 of the smallest edge. Integrals about the
  // origin of coordinates would lose (10 km / 1 m)^2 times more.
  const Eigen::Vector3d edges(0.3, 0.5, 1.1);
  const Mesh far = moved(box_mesh(edges), Eigen::Quaterniond::Identity(), {1e4, 1e4, 1e4});
  const MassProperties found = mesh_mass_properties(far);
  const MassProperties box = box_mass_properties(edges);
  CHECK(std::abs(found.volume / box.volume - 1) < 2e-11);          // measured 2.2e-12
  CHECK(relative_difference(found.inertia, box.inertia) < 2e-11);  // measured 2.6e-12
}

TEST_CASE("inside_out_mesh_has_negative_volume") {
  Mesh box = box_mesh({1, 2, 3});
  for (auto& triangle : box.triangles) std::swap(triangle[0], triangle[1]);
  CHECK(signed_volume(box) == doctest::Approx(-6));
}
