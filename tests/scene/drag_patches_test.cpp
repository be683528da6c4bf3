// SPDX-License-Identifier: MIT
// The pieces of a surface that the wind presses on.
#include "scene/drag_patches.h"

#include <doctest/doctest.h>

#include "shape/primitives.h"

using verisim::scene::make_drag_patches;

TEST_CASE("drag_patches_cover_a_box_once_and_point_outward") {
  const Eigen::Vector3d edges(0.4, 0.02, 0.1);
  double area = 0;
  Eigen::Vector3d along[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (const verisim::dem::DragPatch& patch : make_drag_patches(verisim::shape::box_mesh(edges))) {
    area += patch.area;
    CHECK(patch.normal_b.dot(patch.position_b) > 0);
    for (int k = 0; k < 3; ++k) {
      along[patch.normal_b[k] > 0 ? 0 : 1][k] += patch.area * std::abs(patch.normal_b[k]);
    }
  }
  CHECK(area == doctest::Approx(2 * (0.4 * 0.02 + 0.02 * 0.1 + 0.1 * 0.4)).epsilon(1e-12));
  for (const Eigen::Vector3d& side : along) {
    CHECK(side.x() == doctest::Approx(0.02 * 0.1).epsilon(1e-12));
    CHECK(side.y() == doctest::Approx(0.4 * 0.1).epsilon(1e-12));
  }
}
