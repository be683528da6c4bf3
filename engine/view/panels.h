// SPDX-License-Identifier: MIT
// The panels beside and over the scene: what they show, and what the user asks of them.
#pragma once

#include <optional>
#include <string>

#include "view/live_scene.h"
#include "view/pose_player.h"
#include "view/rate_meter.h"
#include "view/theme.h"

namespace verisim::view {

constexpr int kSlowest = 5;  // 1/2^5 of real time

/// What the user can switch; panels and keys both change it.
struct Controls {
  bool running = true;
  int slow_motion = 0;  // time runs at 1 / 2^slow_motion
  bool show_particles = false;
  bool show_help = false;
  // Asked for once; whoever does it resets it.
  bool reset_camera = false, restart = false, step = false, step_frame = false;

  /// A slider that restarts the scene where it is let go, while it is held.
  struct Held {
    std::string key;
    double value;
  };
  std::optional<Held> held;
  std::string note;     // what the last action did
  std::string problem;  // why it could not

  double time_scale() const { return 1.0 / (1 << slow_motion); }
};

/// Ranges of the sliders, from the scene as it was loaded.
struct Ranges {
  double stiffness_low, stiffness_high;          // N/m
  double dt_low, dt_high;                        // s
  double particle_size_low, particle_size_high;  // m; both 0 where every body is one particle
  double penetration_low, penetration_high;      // m, of method dem
  dem::Method method;                            // that the ranges are for
};

Ranges ranges_of(const scene::BuiltScene& built);

/// The panel of a scene that runs: transport, readings, physics, changes.
void draw_live_panel(const Fonts& fonts, LiveScene& live, const RateMeter& meter,
                     const Ranges& ranges, Controls& controls);

/// The panel of a pose log, and its time line under the picture.
void draw_player_panel(const Fonts& fonts, const std::string& scene_name, PosePlayer& player,
                       const RateMeter& meter, bool has_particles, Controls& controls);

/// Over the picture: what went wrong in the run, and the keys if asked for.
void draw_failure_banner(const dem::Failure& failure, bool stopped);
void draw_help(bool is_player);

}  // namespace verisim::view
