// SPDX-License-Identifier: MIT
// Which body the mouse is on, and how a grip holds it.
#include "view/picking.h"

#include <doctest/doctest.h>

#include <numbers>

#include "shape/primitives.h"
#include "view/grip.h"

using namespace verisim;

namespace {

const render::Camera kCamera{{0, -4, 0}, {0, 0, 0}, 40};

dem::Pose at(double x, double y, double z) {
  dem::Pose pose;
  pose.position = {x, y, z};
  return pose;
}

struct Bodies {
  std::vector<shape::Mesh> meshes;
  std::vector<double> radii;
  std::vector<dem::Pose> poses;

  void add_box(const Eigen::Vector3d& edges, const dem::Pose& pose) {
    meshes.push_back(shape::box_mesh(edges));
    radii.push_back(view::bounding_radius(meshes.back()));
    poses.push_back(pose);
  }
  std::optional<view::Pick> pick(const view::Ray& ray) const {
    return view::pick_body(ray, meshes, radii, poses);
  }
};

}  // namespace

TEST_CASE("the_ray_of_a_pixel_passes_through_what_is_seen_there") {
  const Eigen::Vector3d point(0.7, 0.4, -0.3);
  const auto pixel = view::pixel_of_point(kCamera, 640, 480, point);
  REQUIRE(pixel);
  const view::Ray ray = view::ray_of_pixel(kCamera, 640, 480, *pixel);
  const Eigen::Vector3d to_point = point - ray.origin;
  const double aside = (to_point - to_point.dot(ray.direction) * ray.direction).norm();
  CHECK(aside < 1e-5);  // m, measured 2e-7 (the camera's matrices are in float)
}

TEST_CASE("right_of_the_middle_is_right_and_below_it_is_down") {
  const view::Ray ray = view::ray_of_pixel(kCamera, 640, 480, {400, 300});
  CHECK(ray.direction.x() > 0);
  CHECK(ray.direction.z() < 0);
  CHECK(ray.direction.y() > 0.9);
}

TEST_CASE("a_point_behind_the_eye_is_not_seen") {
  CHECK_FALSE(view::pixel_of_point(kCamera, 640, 480, {0, -5, 0}));
}

TEST_CASE("the_nearest_of_two_bodies_in_line_is_picked") {
  Bodies bodies;
  bodies.add_box({1, 1, 1}, at(0, 2, 0));
  bodies.add_box({0.4, 0.4, 0.4}, at(0, 0, 0));
  const auto pick = bodies.pick({kCamera.position, Eigen::Vector3d::UnitY()});
  REQUIRE(pick);
  CHECK(pick->body == 1);
  CHECK(pick->distance == doctest::Approx(3.8).epsilon(1e-12));
  CHECK((pick->point - Eigen::Vector3d(0, -0.2, 0)).norm() < 1e-12);  // measured 2e-16
  std::swap(bodies.poses[0], bodies.poses[1]);
  CHECK(bodies.pick({kCamera.position, Eigen::Vector3d::UnitY()})->body == 0);
}

TEST_CASE("a_turned_body_is_picked_where_it_is") {
  // A rod along x, turned by 45 degrees about y: its right end points down.
  Bodies bodies;
  dem::Pose pose = at(0, 0, 0);
  pose.orientation = Eigen::AngleAxisd(std::numbers::pi / 4, Eigen::Vector3d::UnitY());
  bodies.add_box({2, 0.1, 0.1}, pose);
  CHECK(bodies.pick({{0.6, -4, -0.6}, Eigen::Vector3d::UnitY()}));
  CHECK_FALSE(bodies.pick({{0.6, -4, 0.6}, Eigen::Vector3d::UnitY()}));
  CHECK_FALSE(bodies.pick({{0.6, -4, 0}, Eigen::Vector3d::UnitY()}));
}

TEST_CASE("a_ray_inside_the_bounding_sphere_may_still_miss_the_body") {
  Bodies bodies;
  bodies.add_box({2, 0.1, 0.1}, at(0, 0, 0));
  CHECK_FALSE(bodies.pick({{0, -4, 0.5}, Eigen::Vector3d::UnitY()}));
}

TEST_CASE("a_body_behind_the_eye_is_not_picked") {
  Bodies bodies;
  bodies.add_box({1, 1, 1}, at(0, -8, 0));
  CHECK_FALSE(bodies.pick({kCamera.position, Eigen::Vector3d::UnitY()}));
}

TEST_CASE("a_dragged_point_stays_under_the_mouse_at_its_depth") {
  const Eigen::Vector3d grip(0.2, 0.5, 0.1);
  const Eigen::Vector2d pixel(100, 80);
  const view::Ray ray = view::ray_of_pixel(kCamera, 640, 480, pixel);
  const Eigen::Vector3d target = view::follow_mouse(ray, kCamera, grip);
  CHECK(target.y() == doctest::Approx(grip.y()).epsilon(1e-12));
  const auto seen = view::pixel_of_point(kCamera, 640, 480, target);
  REQUIRE(seen);
  CHECK((*seen - pixel).norm() < 0.01);  // pixels, measured 2e-5
}

TEST_CASE("a_grip_holds_the_picked_point_of_the_body") {
  dem::Pose pose = at(1, 2, 3);
  pose.orientation = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  const view::Pick pick{0, 1, {1.1, 1.9, 3.2}};
  const dem::Drag drag = view::grip_body(pick, pose, 2.5);
  CHECK((view::grip_point(drag, pose) - pick.point).norm() < 1e-12);  // measured 0
  CHECK((drag.target - pick.point).norm() == 0);
  // 3 Hz at 70 % of critical damping for a body of 2.5 kg.
  const double omega = std::sqrt(drag.stiffness / 2.5);
  CHECK(omega / (2 * std::numbers::pi) == doctest::Approx(3));
  CHECK(drag.damping / (2 * 2.5 * omega) == doctest::Approx(0.7));
}
