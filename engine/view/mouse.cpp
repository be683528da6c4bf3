// SPDX-License-Identifier: MIT
#include "view/mouse.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>

namespace verisim::view {
namespace {

constexpr double kFasterFlight = 4;

double held(int key) { return ImGui::IsKeyDown(key) ? 1 : 0; }

Eigen::Vector2d pixel_under_mouse(const Picture& picture) {
  const ImVec2 at = ImGui::GetIO().MousePos;
  return picture.pixels_per_unit * Eigen::Vector2d(at.x, at.y);
}

Ray ray_under_mouse(const Picture& picture, const CameraControl& camera) {
  return ray_of_pixel(camera_of(camera), picture.width, picture.height, pixel_under_mouse(picture));
}

void fly_by_keys(CameraControl& camera) {
  const ImGuiIO& io = ImGui::GetIO();
  Eigen::Vector3d heading(held(GLFW_KEY_D) - held(GLFW_KEY_A), held(GLFW_KEY_W) - held(GLFW_KEY_S),
                          held(GLFW_KEY_E) - held(GLFW_KEY_Q));
  if (io.KeyShift) heading *= kFasterFlight;
  fly(camera, heading, static_cast<double>(io.DeltaTime));
}

}  // namespace

void Mouse::handle(const Picture& picture, CameraControl& camera, LiveScene* live) {
  const ImGuiIO& io = ImGui::GetIO();
  const double right_px = picture.pixels_per_unit * static_cast<double>(io.MouseDelta.x);
  const double down_px = picture.pixels_per_unit * static_cast<double>(io.MouseDelta.y);
  if (!io.WantCaptureMouse) {
    if (io.MouseWheel != 0) zoom(camera, static_cast<double>(io.MouseWheel));
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Left) && !io.KeyShift && live != nullptr) {
      begin_drag(picture, camera, *live);
    } else if (drag_) {
      drag_->target =
          follow_mouse(ray_under_mouse(picture, camera), camera_of(camera), drag_->target);
    } else if (ImGui::IsMouseDown(ImGuiMouseButton_Right)) {
      look_around(camera, right_px, down_px);
      fly_by_keys(camera);
    } else if (ImGui::IsMouseDown(ImGuiMouseButton_Left) ||
               ImGui::IsMouseDown(ImGuiMouseButton_Middle)) {
      if (io.KeyShift) {
        pan(camera, right_px, down_px, picture.height);
      } else {
        orbit(camera, right_px, down_px);
      }
    }
  }
  if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) drag_.reset();
  if (live != nullptr && (drag_ || is_holding_)) live->hold(drag_);
  is_holding_ = drag_.has_value();
}

void Mouse::begin_drag(const Picture& picture, const CameraControl& camera, LiveScene& live) {
  if (generation_ != live.generation()) {
    radii_.clear();
    for (const shape::Mesh& mesh : live.built().meshes) radii_.push_back(bounding_radius(mesh));
    generation_ = live.generation();
  }
  const std::vector<dem::Pose> poses = live.poses();
  const auto pick = pick_body(ray_under_mouse(picture, camera), live.built().meshes, radii_, poses);
  if (!pick || live.world().bodies.motion[pick->body] != dem::Motion::kFree) return;
  drag_ = grip_body(*pick, poses[pick->body], live.world().bodies.mass[pick->body]);
}

void Mouse::draw_grip(const Picture& picture, const CameraControl& camera,
                      const LiveScene& live) const {
  if (!drag_) return;
  const dem::Pose pose = dem::pose_of(live.world(), drag_->body);
  const auto on_screen = [&](const Eigen::Vector3d& point) {
    const auto pixel = pixel_of_point(camera_of(camera), picture.width, picture.height, point);
    const Eigen::Vector2d units = pixel.value_or(Eigen::Vector2d::Zero()) / picture.pixels_per_unit;
    return ImVec2(static_cast<float>(units.x()), static_cast<float>(units.y()));
  };
  const ImVec2 grip = on_screen(grip_point(*drag_, pose)), target = on_screen(drag_->target);
  ImDrawList* over = ImGui::GetBackgroundDrawList();
  over->AddLine(grip, target, IM_COL32(20, 22, 25, 200), 5);
  over->AddLine(grip, target, IM_COL32(250, 250, 250, 240), 2.5F);
  over->AddCircleFilled(grip, 5, ImGui::GetColorU32(kAccent));
  over->AddCircle(target, 8, IM_COL32(250, 250, 250, 240), 0, 2);
}

namespace {

void handle_key(const KeyPress& press, Controls& controls) {
  if (press.key == GLFW_KEY_PERIOD) controls.step = true;
  if (press.key == GLFW_KEY_RIGHT) controls.step_frame = true;
  if (press.key == GLFW_KEY_R && !press.is_repeat) controls.restart = true;
}

void handle_key(const KeyPress& press, Controls& controls, PosePlayer& player) {
  const int frames = press.key == GLFW_KEY_RIGHT ? 1 : press.key == GLFW_KEY_LEFT ? -1 : 0;
  if (frames != 0) controls.running = false;
  player.step(frames);
  if (press.key == GLFW_KEY_HOME) player.seek(0);
  if (press.key == GLFW_KEY_END) player.seek(player.num_frames() - 1);
}

}  // namespace

void handle_keys(const std::vector<KeyPress>& keys, Controls& controls, PosePlayer* player) {
  if (ImGui::GetIO().WantTextInput || ImGui::IsAnyItemActive()) return;
  for (const KeyPress& press : keys) {
    if (player != nullptr) {
      handle_key(press, controls, *player);
    } else {
      handle_key(press, controls);
    }
    if (press.is_repeat) continue;
    const int slower = press.key == GLFW_KEY_DOWN ? 1 : press.key == GLFW_KEY_UP ? -1 : 0;
    controls.slow_motion = std::clamp(controls.slow_motion + slower, 0, kSlowest);
    if (press.key == GLFW_KEY_SPACE) controls.running = !controls.running;
    if (press.key == GLFW_KEY_H) controls.show_help = !controls.show_help;
    if (press.key == GLFW_KEY_P) controls.show_particles = !controls.show_particles;
    if (press.key == GLFW_KEY_C) controls.reset_camera = true;
  }
}

}  // namespace verisim::view
