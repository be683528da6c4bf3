// SPDX-License-Identifier: MIT
#include "view/application.h"

#include <imgui.h>

#include <algorithm>
#include <chrono>

#include "render/renderer.h"
#include "view/mouse.h"
#include "view/panels.h"
#include "view/window.h"

namespace verisim::view {
namespace {

constexpr int kWidth = 1280, kHeight = 720;  // units, at the start
constexpr double kLongestFrame = 0.1;        // s; after a longer one, time stands still
constexpr double kIdleWait = 0.1;            // s between pictures when nothing moves
constexpr int kFramesToSettle = 3;           // Dear ImGui sizes its windows within two

class Viewer {
 public:
  Viewer(const scene::Scene& scene, const ViewOptions& options)
      : options_(options),
        live_(scene, options.overrides),
        ranges_(ranges_of(live_.built())),
        window_("Verisim - " + scene.name, kWidth, kHeight),
        fonts_(apply_theme()) {
    if (options.poses) player_.emplace(*options.poses);
    controls_.show_particles = options.show == clip::Show::kParticles;
    look_again();
    camera_ = control_of(renderer_->scene().camera);
  }

  /// One frame; false when the window is to close.
  bool frame() {
    const bool is_idle = !controls_.running && !is_to_be_shot() && !ImGui::IsAnyMouseDown();
    if (!window_.start_frame(is_idle ? kIdleWait : 0)) return false;
    const Clock::time_point now = Clock::now();
    const double wall = std::chrono::duration<double>(now - last_frame_).count();
    last_frame_ = now;

    LiveScene* live = player_ ? nullptr : &live_;
    handle_keys(window_.keys(), controls_, player_ ? &*player_ : nullptr);
    mouse_.handle(picture(), camera_, live);
    do_what_was_asked();
    meter_.add(wall, advance(std::min(wall, kLongestFrame)));
    draw_scene();
    draw_panels();
    const bool is_last = is_to_be_shot() && is_time_reached() && ++settled_ > kFramesToSettle;
    window_.end_frame(is_last ? options_.screenshot : "");
    return !is_last;
  }

 private:
  using Clock = std::chrono::steady_clock;

  bool is_to_be_shot() const { return !options_.screenshot.empty(); }

  bool is_time_reached() const {
    if (player_) return player_->at_end() || player_->time() >= options_.after;
    return live_.stopped() || time_left() < live_.world().parameters.dt;
  }

  double time_left() const { return options_.after - live_.world().time; }  // until the picture

  Picture picture() const {
    const double scale = window_.pixels_per_unit();
    const Eigen::Vector2i size = window_.size();
    const int panel = static_cast<int>(static_cast<double>(kPanelWidth) * scale);
    return {std::max(size.x() - panel, 2), std::max(size.y(), 2), scale};
  }

  void do_what_was_asked() {
    if (controls_.restart) {
      controls_.problem = live_.restart();
      mouse_.release();
    }
    if (controls_.step || controls_.step_frame) controls_.running = false;
    if (controls_.step) live_.step();
    if (controls_.step_frame) live_.advance(1 / live_.scene().frame_rate, 1);
    if (controls_.reset_camera) camera_ = control_of(first_camera_);
    controls_.restart = controls_.step = controls_.step_frame = controls_.reset_camera = false;
  }

  /// Advances by at most what the wall clock asks; returns the simulated seconds.
  double advance(double wall) {
    const double pace = controls_.running ? controls_.time_scale() : 0;
    if (pace != pace_) meter_ = {};  // the speed before says nothing about the speed now
    if (pace > pace_ && pace_ == 0 && player_ && player_->at_end()) player_->seek(0);
    pace_ = pace;
    if (pace == 0) return 0;
    double seconds = wall * pace;
    if (player_) {
      player_->advance(is_to_be_shot() ? std::min(seconds, options_.after - player_->time())
                                       : seconds);
      if (player_->at_end()) controls_.running = false;
      return seconds;
    }
    if (is_to_be_shot()) seconds = std::clamp(time_left(), 0.0, seconds);
    return live_.advance(seconds, std::clamp(drawing_, 0.01, 0.04));
  }

  /// Makes the renderer anew: for other bodies, or particles for surfaces.
  void look_again() {
    const auto show = controls_.show_particles ? clip::Show::kParticles : clip::Show::kMesh;
    const render::VisualScene look = clip::visualise(live_.scene(), live_.built(), show);
    first_camera_ = look.camera;
    renderer_.reset();
    renderer_.emplace(window_.get_proc_address(), look, picture().width, picture().height);
    drawn_generation_ = live_.generation();
    drawn_particles_ = controls_.show_particles;
  }

  void draw_scene() {
    const Clock::time_point start = Clock::now();
    if (drawn_generation_ != live_.generation() || drawn_particles_ != controls_.show_particles) {
      look_again();
    }
    const Picture area = picture();
    if (area.width != renderer_->width() || area.height != renderer_->height()) {
      renderer_->resize(area.width, area.height);
    }
    std::vector<dem::Pose> poses = live_.poses();
    if (player_) poses.assign(player_->poses().begin(), player_->poses().end());
    renderer_->set_camera(camera_of(camera_));
    renderer_->fit_light(poses);
    renderer_->draw(poses);
    window_.clear();
    renderer_->copy_to(0);
    drawing_ = std::chrono::duration<double>(Clock::now() - start).count();
  }

  void draw_panels() {
    if (ranges_.method != live_.world().parameters.method) ranges_ = ranges_of(live_.built());
    if (player_) {
      draw_player_panel(fonts_, live_.scene().name, *player_, meter_, !live_.world().surfaces,
                        controls_);
    } else {
      draw_live_panel(fonts_, live_, meter_, ranges_, controls_);
      mouse_.draw_grip(picture(), camera_, live_);
      if (!live_.failures().empty()) {
        draw_failure_banner(live_.failures().front(), live_.stopped());
      }
    }
    if (controls_.show_help) draw_help(player_.has_value());
  }

  const ViewOptions& options_;
  LiveScene live_;
  std::optional<PosePlayer> player_;
  Ranges ranges_;
  Window window_;
  Fonts fonts_;
  Controls controls_;
  CameraControl camera_;
  render::Camera first_camera_;
  Mouse mouse_;
  RateMeter meter_;
  std::optional<render::Renderer> renderer_;
  int drawn_generation_ = 0;
  bool drawn_particles_ = false;
  int settled_ = 0;     // frames drawn at the time of the screenshot
  double pace_ = 0;     // simulated seconds asked for per second, in the frame before
  double drawing_ = 0;  // s, of the last picture
  Clock::time_point last_frame_ = Clock::now();
};

}  // namespace

void view(const scene::Scene& scene, const ViewOptions& options,
          const std::function<void()>& each_frame) {
  Viewer viewer(scene, options);
  while (viewer.frame()) each_frame();
}

}  // namespace verisim::view
