// SPDX-License-Identifier: MIT
// What a picture must show: bodies where they are, shadows that touch, rotation, no white.
#include "render/renderer.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "render/render_error.h"
#include "small_scene.h"

namespace verisim::render {
namespace {

struct PixelPosition {
  double x, y;  // px from the bottom left
};

/// Pin-hole projection in double precision, written apart from the renderer's matrices.
PixelPosition project(const Still& still, const Eigen::Vector3d& point) {
  const Camera& camera = still.scene.camera;
  const Eigen::Vector3d forward = (camera.look_at - camera.position).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d ray = point - camera.position;
  const double focal = still.height / 2.0 / std::tan(camera.fov_deg * EIGEN_PI / 360);
  const double depth = ray.dot(forward);
  return {still.width / 2.0 + focal * ray.dot(right) / depth,
          still.height / 2.0 + focal * ray.dot(right.cross(forward)) / depth};
}

int luma_at(const Still& still, const Pixels& pixels, const PixelPosition& at) {
  const auto index =
      4 * (static_cast<std::size_t>(at.y) * still.width + static_cast<std::size_t>(at.x));
  return (2 * pixels[index] + 7 * pixels[index + 1] + pixels[index + 2]) / 10;
}

/// Mean position and number of the pixels that differ by more than `tolerance` in a channel.
struct Difference {
  PixelPosition center;
  int num_pixels;
};

Difference difference(const Still& still, const Pixels& a, const Pixels& b, int tolerance = 0) {
  Difference found{{0, 0}, 0};
  for (int y = 0; y < still.height; ++y) {
    for (int x = 0; x < still.width; ++x) {
      const auto index = 4 * (static_cast<std::size_t>(y) * still.width + x);
      int worst = 0;
      for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(a[index + c] - b[index + c]));
      if (worst <= tolerance) continue;
      found.center.x += x + 0.5;
      found.center.y += y + 0.5;
      ++found.num_pixels;
    }
  }
  found.center.x /= std::max(found.num_pixels, 1);
  found.center.y /= std::max(found.num_pixels, 1);
  return found;
}

}  // namespace

TEST_CASE("a_ball_appears_where_the_pin_hole_camera_puts_it") {
  Still still = empty_still();
  still.scene.ground.present = false;  // no shadow: only the ball differs from the background
  const Pixels background = picture_of(still);
  for (const Eigen::Vector3d& position :
       {Eigen::Vector3d(0, 0, 0.15), Eigen::Vector3d(-0.3, 0.2, 0.4), Eigen::Vector3d(0.3, 0, 0)}) {
    Still with_ball = still;
    with_ball.add_ball(0.03, position);
    const Difference seen = difference(still, background, picture_of(with_ball));
    const PixelPosition expected = project(still, position);
    CHECK(seen.num_pixels > 40);
    // measured 0.21 px at most, from whole pixels; 0.5 would be an offset in the projection
    CHECK(std::hypot(seen.center.x - expected.x, seen.center.y - expected.y) < 0.25);
  }
}

TEST_CASE("the_shadow_of_a_resting_box_touches_the_box") {
  Still without = empty_still();
  without.scene.sun.direction = {-0.6, 0, 0.8};  // from the left: the shadow falls in sight
  without.width = 640;
  without.height = 360;
  Still still = without;
  still.add_box({0.2, 0.2, 0.2}, {0, 0, 0.1});
  const Pixels with_box = picture_of(still), background = picture_of(without);
  for (const double gap : {0.004, 0.01, 0.03, 0.1}) {  // m from the box; 0.004 is 1.5 pixels
    CAPTURE(gap);
    const PixelPosition at = project(still, {0.1 + gap, 0, 0});
    // measured 0.61 to 0.64 of the sunlit luma
    CHECK(luma_at(still, with_box, at) < 0.75 * luma_at(without, background, at));
    CHECK(luma_at(still, with_box, at) > 0.4 * luma_at(without, background, at));
  }
  // The box is 0.2 m high and the sun's slope 4 to 3: its shadow ends 0.15 m from the box.
  for (const Eigen::Vector3d& sunny : {Eigen::Vector3d(0.27, 0, 0), Eigen::Vector3d(-0.2, 0, 0)}) {
    const PixelPosition at = project(still, sunny);
    CHECK(luma_at(still, with_box, at) == luma_at(without, background, at));
  }
}

TEST_CASE("rotation_of_a_ball_shows") {
  Still still = empty_still();
  still.add_ball(0.15, {0, 0, 0.15});
  const Pixels upright = picture_of(still);
  Still turned = still;
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)}) {
    turned.poses[0].orientation = Eigen::AngleAxisd(0.1, axis);
    // measured 174 or more; shading that follows the triangles alone stays within 10 levels
    CHECK(difference(still, upright, picture_of(turned), 10).num_pixels > 100);
  }
}

TEST_CASE("nothing_is_clipped_to_white") {
  Still still = small_still();
  // Light things of every palette colour, with a face turned straight to the sun.
  for (int i = 0; i < 7; ++i) still.add_ball(0.05, {-0.4 + 0.12 * i, -0.3, 0.05});
  still.scene.bodies[0].colour = {0.9F, 0.9F, 0.9F};
  const Pixels pixels = picture_of(still);
  int brightest = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (i % 4 != 3) brightest = std::max<int>(brightest, pixels[i]);
  }
  CHECK(brightest < 250);  // measured 230
  CHECK(brightest > 180);  // nor is the picture dull
}

TEST_CASE("a_frame_does_not_depend_on_the_frames_before_it") {
  const auto context = make_context(ContextKind::kAuto, 0);
  const Still first = small_still();
  Still second = first;
  second.poses[0].position.x() = -0.4;
  second.poses[1].position.z() = 0.4;
  second.poses[2].position = {0.1, -0.2, 0.06};
  Renderer renderer(context->get_proc_address(), first.scene, first.width, first.height);
  std::vector<dem::Pose> both = first.poses;
  both.insert(both.end(), second.poses.begin(), second.poses.end());
  renderer.fit_light(both);
  const Pixels fresh = picture_of(renderer, second.poses);
  picture_of(renderer, first.poses);
  CHECK(picture_of(renderer, second.poses) == fresh);
  Camera other = first.scene.camera;
  other.position.z() += 0.5;
  renderer.set_camera(other);
  CHECK(picture_of(renderer, second.poses) != fresh);
  renderer.set_camera(first.scene.camera);
  CHECK(picture_of(renderer, second.poses) == fresh);
}

TEST_CASE("the_ground_hides_what_is_below_it") {
  Still still = empty_still();
  const Pixels background = picture_of(still);
  still.add_box({0.2, 0.2, 0.2}, {0, 0, -0.11});
  CHECK(picture_of(still) == background);
  still.scene.ground.present = false;
  CHECK(difference(still, background, picture_of(still)).num_pixels > 500);
}

TEST_CASE("what_fell_through_the_ground_casts_no_shadow_on_it") {
  const Pixels background = picture_of(empty_still());
  for (const double height : {-0.5, -1.0, -2.0, -4.0, -8.0}) {
    Still still = empty_still();
    still.add_ball(0.15, {0.3, 0.2, height});
    CHECK(difference(still, background, picture_of(still)).num_pixels == 0);
  }
}

TEST_CASE("ground_tiles_have_the_stated_size") {
  Still still = empty_still();
  // Straight down from 2 m: one tile of 0.25 m spans height / (2 * 2 m * tan 20 deg) * 0.25 m.
  still.scene.camera = {{0.01, 0.01, 2}, {0.01, 0.01, 0}, 40};
  const Pixels pixels = picture_of(still);
  const double expected_px = still.height / (4 * std::tan(20 * EIGEN_PI / 180)) * 0.25;
  std::vector<int> edges;  // columns where the tone changes
  const double y = still.height / 2.0 + 10;
  const auto luma = [&](int x) { return luma_at(still, pixels, {static_cast<double>(x), y}); };
  const int middle = (luma(10) + luma(10 + static_cast<int>(expected_px))) / 2;
  for (int x = 1; x < still.width; ++x) {
    if ((luma(x) > middle) != (luma(x - 1) > middle)) edges.push_back(x);
  }
  REQUIRE(edges.size() >= 5);
  const double mean_px =
      static_cast<double>(edges.back() - edges.front()) / static_cast<double>(edges.size() - 1);
  CHECK(mean_px == doctest::Approx(expected_px).epsilon(0.02));  // columns are whole pixels
}

TEST_CASE("particles_can_stand_for_a_body") {
  Still still = empty_still();
  VisualBody body;
  body.pattern = box_pattern({0.2, 0.2, 0.2});
  for (int i = 0; i < 8; ++i) {
    body.spheres.push_back(
        {{i & 1 ? 0.05 : -0.05, i & 2 ? 0.05 : -0.05, i & 4 ? 0.05 : -0.05}, 0.05});
  }
  const Pixels background = picture_of(still);
  still.add(std::move(body), {0, 0, 0.1});
  CHECK(difference(still, background, picture_of(still)).num_pixels > 1000);
}

TEST_CASE("impossible_pictures_are_refused") {
  const auto context = make_context(ContextKind::kAuto, 0);
  Still still = small_still();
  CHECK_THROWS_AS(Renderer(context->get_proc_address(), still.scene, 0, 100), RenderError);
  CHECK_THROWS_AS(Renderer(context->get_proc_address(), still.scene, 100, 20000), RenderError);
  still.scene.camera.look_at = still.scene.camera.position;
  CHECK_THROWS_AS(picture_of(*context, still), RenderError);
}

}  // namespace verisim::render
