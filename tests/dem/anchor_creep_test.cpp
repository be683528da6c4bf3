// SPDX-License-Identifier: MIT
// The creep of contacts that stick, from poses and stretches set by hand.
#include "dem/anchor_creep.h"

#include <doctest/doctest.h>

using namespace verisim::dem;
using Eigen::Vector3d;

namespace {

/// A box that rests on a plane with one corner, which grips.
struct Resting {
  CollisionShape box_shape = BoxShape{}, plane_shape = PlaneShape{};
  BodyState box, plane;
  ContactPair pair;
  Resting() {
    box.shape = &box_shape;
    plane.shape = &plane_shape;
    box.position = {0, 0, 0.5};
    ContactPoint point;
    point.place = {0.1, 0, 0};
    point.is_touching = true;
    pair.points.push_back(point);
    follow_anchors(pair, box, plane);
  }
  ContactPoint& point() { return pair.points.front(); }
};

}  // namespace

TEST_CASE("a_box_that_moves_by_its_springs_stretch_does_not_creep") {
  Resting resting;
  resting.box.position.x() += 1e-4;
  resting.point().stretch_b.x() += 1e-4;
  CHECK(follow_anchors(resting.pair, resting.box, resting.plane) < 1e-16);  // measured 1.4e-17
}

TEST_CASE("a_box_that_moves_while_its_spring_does_not_stretch_creeps") {
  Resting resting;
  resting.box.position.x() += 1e-4;
  resting.box.position.z() -= 1e-3;  // along the normal: no creep
  CHECK(follow_anchors(resting.pair, resting.box, resting.plane) == doctest::Approx(1e-4));
}

TEST_CASE("a_contact_that_slid_grips_anew") {
  Resting resting;
  resting.box.position.x() += 1e-4;
  resting.point().has_slid = true;
  CHECK(follow_anchors(resting.pair, resting.box, resting.plane) == 0);
  CHECK_FALSE(resting.point().has_slid);
  resting.box.position.x() += 1e-5;
  resting.point().place.x() += 1e-4;
  CHECK(follow_anchors(resting.pair, resting.box, resting.plane) == doctest::Approx(1e-5));
}
