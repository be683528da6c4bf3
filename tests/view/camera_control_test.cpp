// SPDX-License-Identifier: MIT
// The camera by hand: what each move keeps and where it leads.
#include "view/camera_control.h"

#include <doctest/doctest.h>

#include <numbers>

#include "view/picking.h"

using namespace verisim;

namespace {

const render::Camera kCamera{{1.2, -1.5, 0.8}, {0.1, 0.2, 0.3}, 40};

// Distance in pixels between where two cameras see points.
Eigen::Vector2d seen(const view::CameraControl& control, const Eigen::Vector3d& point) {
  return *view::pixel_of_point(view::camera_of(control), 800, 600, point);
}

}  // namespace

TEST_CASE("a_camera_survives_the_way_to_a_control_and_back") {
  const render::Camera back = view::camera_of(view::control_of(kCamera));
  CHECK((back.position - kCamera.position).norm() < 1e-12);  // measured 0
  CHECK((back.look_at - kCamera.look_at).norm() == 0);
  CHECK(back.fov_deg == kCamera.fov_deg);
}

TEST_CASE("orbit_keeps_the_target_and_its_distance") {
  view::CameraControl control = view::control_of(kCamera);
  view::orbit(control, 123, -45);
  const render::Camera camera = view::camera_of(control);
  CHECK(camera.look_at == kCamera.look_at);
  CHECK((camera.position - camera.look_at).norm() ==
        doctest::Approx((kCamera.position - kCamera.look_at).norm()).epsilon(1e-12));
  CHECK((camera.position - kCamera.position).norm() > 0.1);
}

TEST_CASE("orbit_turns_the_near_side_with_the_mouse") {
  view::CameraControl control = view::control_of(kCamera);
  const Eigen::Vector3d near = kCamera.look_at + 0.2 * (kCamera.position - kCamera.look_at);
  view::orbit(control, 20, 10);
  CHECK(seen(control, near).x() > 400);  // the middle before
  CHECK(seen(control, near).y() > 300);
}

TEST_CASE("orbit_never_turns_over_the_top") {
  view::CameraControl control = view::control_of(kCamera);
  view::orbit(control, 0, 1e6);
  CHECK(control.elevation < std::numbers::pi / 2);
  const render::Camera camera = view::camera_of(control);
  CHECK(camera.position.z() > camera.look_at.z());
}

TEST_CASE("pan_carries_the_target_with_the_mouse") {
  view::CameraControl control = view::control_of(kCamera);
  view::pan(control, 37, -12, 600);
  const Eigen::Vector2d at = seen(control, kCamera.look_at);
  CHECK(std::abs(at.x() - 437) < 0.05);  // measured 0; the projection is in float
  CHECK(std::abs(at.y() - 288) < 0.05);  // measured 0
}

TEST_CASE("zoom_nears_by_a_tenth_per_notch_and_never_reaches_the_target") {
  view::CameraControl control = view::control_of(kCamera);
  const double before = control.distance;
  view::zoom(control, 1);
  CHECK(control.distance == doctest::Approx(0.9 * before));
  view::zoom(control, -1);
  CHECK(control.distance == doctest::Approx(before));
  view::zoom(control, 1e6);
  CHECK(control.distance > 0);
}

TEST_CASE("looking_around_keeps_the_eye") {
  view::CameraControl control = view::control_of(kCamera);
  view::look_around(control, 50, 20);
  CHECK((view::camera_of(control).position - kCamera.position).norm() < 1e-12);  // measured 0
  // The head turns right and down, so what was in the middle is now left of it and above.
  CHECK(seen(control, kCamera.look_at).x() < 400);
  CHECK(seen(control, kCamera.look_at).y() < 300);
}

TEST_CASE("flying_forward_goes_where_the_camera_looks") {
  view::CameraControl control = view::control_of(kCamera);
  view::fly(control, {0, 1, 0}, 0.5);
  const Eigen::Vector3d way = view::camera_of(control).position - kCamera.position;
  const Eigen::Vector3d forward = (kCamera.look_at - kCamera.position).normalized();
  CHECK(way.normalized().dot(forward) > 1 - 1e-12);  // measured 1
  CHECK(way.norm() == doctest::Approx(0.25 * (kCamera.look_at - kCamera.position).norm()));
}
