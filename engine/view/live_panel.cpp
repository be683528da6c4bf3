// SPDX-License-Identifier: MIT
// The panel of a scene that runs.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "dem/surface_contacts.h"
#include "scene/key_table.h"
#include "scene/problem.h"
#include "view/panel_parts.h"
#include "view/save_scene.h"
#include "view/view_error.h"

namespace verisim::view {
namespace {

constexpr double kSlowerThanAsked = 0.9;                    // of the speed chosen
constexpr double kMaxRatio = 3;                             // damping and friction sliders
constexpr double kFewestSteps = 6, kMostSteps = 200;        // of method dem, in one impact
constexpr double kFewestSubsteps = 1, kMostSubsteps = 100;  // of method xpbd, in one frame

const scene::Key& physics_key(const std::string& name) {
  const auto find = [](const std::vector<scene::Key>& keys,
                       const std::string& wanted) -> const scene::Key& {
    return *std::find_if(keys.begin(), keys.end(),
                         [&](const scene::Key& key) { return key.name == wanted; });
  };
  return find(find(scene::scene_keys().children, "physics").children, name);
}

void apply(LiveScene& live, const std::string& path, const std::string& value, Effect effect,
           Controls& controls) {
  controls.problem = live.change(path, value, effect);
  controls.note.clear();
}

// How a value is written on its slider.
std::string slider_format(double value, const char* unit) {
  return std::string(value >= 1000 && value < 1e6 ? "%.0f " : "%.4g ") + unit;
}

struct Slider {
  const char* words;
  const char* key;  // of physics
  double low, high;
  const char* unit;
  ImGuiSliderFlags flags = ImGuiSliderFlags_NoRoundToFormat;
  bool is_whole = false;
};

constexpr ImGuiSliderFlags kByPowers =
    ImGuiSliderFlags_NoRoundToFormat | ImGuiSliderFlags_Logarithmic;

bool move_slider(const Slider& slider, double& value) {
  label(slider.words, physics_key(slider.key).description.c_str());
  return ImGui::SliderScalar((std::string("##") + slider.key).c_str(), ImGuiDataType_Double, &value,
                             &slider.low, &slider.high, slider_format(value, slider.unit).c_str(),
                             slider.flags);
}

// Changes the run as the hand moves.
void live_slider(LiveScene& live, const Slider& slider, double value, Controls& controls) {
  if (!move_slider(slider, value)) return;
  apply(live, std::string("physics.") + slider.key, number_text(value), Effect::kGoesOn, controls);
}

// Starts the scene again where the hand lets go; until then shows the hand's value.
void restart_slider(LiveScene& live, const Slider& slider, double value, Controls& controls) {
  std::optional<Controls::Held>& held = controls.held;
  const bool is_held = held && held->key == slider.key;
  double shown = is_held ? held->value : value;
  if (move_slider(slider, shown)) {
    held = {slider.key, slider.is_whole ? std::round(shown) : shown};
  }
  if (!ImGui::IsItemDeactivated() || !held || held->key != slider.key) return;
  apply(live, std::string("physics.") + slider.key, number_text(held->value), Effect::kRestarts,
        controls);
  held.reset();
}

void choice(LiveScene& live, const char* words, const std::string& key,
            const std::vector<std::string>& choices, const std::string& value, Effect effect,
            Controls& controls) {
  label(words, physics_key(key).description.c_str());
  if (!ImGui::BeginCombo(("##" + key).c_str(), value.c_str())) return;
  for (const std::string& name : choices) {
    if (ImGui::Selectable(name.c_str(), name == value) && name != value) {
      apply(live, "physics." + key, name, effect, controls);
    }
  }
  ImGui::EndCombo();
}

void draw_transport(const LiveScene& live, Controls& controls) {
  ImGui::BeginDisabled(live.stopped());
  if (wide_button(controls.running ? "Pause" : "Run", 4)) controls.running = !controls.running;
  ImGui::SameLine();
  if (wide_button("Step", 4)) controls.step = true;
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("One time step");
  ImGui::SameLine();
  if (wide_button("Frame", 4)) controls.step_frame = true;
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("One frame of the clip");
  ImGui::EndDisabled();
  ImGui::SameLine();
  if (wide_button("Restart", 4)) controls.restart = true;
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Read the scene file again, from time 0");
  draw_speed_row(controls);
}

void draw_readings(const LiveScene& live, const RateMeter& meter, const Controls& controls) {
  if (!begin_readings()) return;
  const dem::World& world = live.world();
  reading("Time", text_of("%.3f s", world.time));
  if (controls.running && !live.stopped()) {
    const double factor = meter.real_time_factor();
    const bool is_slow = factor < kSlowerThanAsked * controls.time_scale();
    reading("Real time", text_of(is_slow ? "%.2f x - slower than asked" : "%.2f x", factor),
            is_slow ? &kWarning : nullptr);
  } else {
    reading("Real time", live.stopped() ? "stopped" : "paused");
  }
  reading("Frame rate", text_of("%.0f / s", meter.frames_per_second()));
  if (world.surfaces) {
    reading("Surface points", std::to_string(world.surfaces->num_samples()));
  } else {
    reading("Particles", std::to_string(world.particles.count()));
  }
  reading("Contacts", std::to_string(live.report().num_contacts));
  reading("Deepest overlap", text_of("%.3g mm", 1000 * live.report().max_overlap));
  ImGui::EndTable();
}

void draw_gravity(LiveScene& live, Controls& controls) {
  constexpr double kLow = -20, kHigh = 20;  // m/s^2
  Eigen::Vector3d gravity = live.world().parameters.gravity;
  label("Gravity", "Gravity x, y, z, m/s2. Ctrl-click to type.");
  if (ImGui::DragScalarN("##gravity", ImGuiDataType_Double, gravity.data(), 3, 0.05F, &kLow, &kHigh,
                         "%.2f")) {
    apply(live, "gravity_m_s2",
          "[" + number_text(gravity.x()) + ", " + number_text(gravity.y()) + ", " +
              number_text(gravity.z()) + "]",
          Effect::kGoesOn, controls);
  }
}

void draw_seed(LiveScene& live, const Ranges& ranges, Controls& controls) {
  const dem::Parameters& now = live.world().parameters;
  live_slider(
      live,
      {"Stiffness", "stiffness_n_m", ranges.stiffness_low, ranges.stiffness_high, "N/m", kByPowers},
      now.seed.stiffness, controls);
  live_slider(live, {"Damping ratio", "damping_ratio", 0, kMaxRatio, ""}, now.seed.damping_ratio,
              controls);
  live_slider(live, {"Friction ratio", "tangential_damping_ratio", 0, kMaxRatio, ""},
              now.seed.tangential_damping_ratio, controls);
  live_slider(live, {"Time step", "dt_s", ranges.dt_low, ranges.dt_high, "s", kByPowers}, now.dt,
              controls);
  choice(live, "Integrator", "integrator", {"seed", "rkmk4"},
         std::string(dem::to_string(now.integrator)), Effect::kGoesOn, controls);
  ImGui::TextDisabled("These start the scene again, from time 0:");
  if (ranges.particle_size_high <= 0) return;
  const auto& size = live.scene().physics.particle_size;
  restart_slider(live,
                 {"Particle size", "particle_size_m", ranges.particle_size_low,
                  ranges.particle_size_high, size ? "m" : "m (chosen)", kByPowers},
                 size.value_or(ranges.particle_size_high / 4), controls);
}

void draw_dem(LiveScene& live, const Ranges& ranges, Controls& controls) {
  const dem::DemSettings& now = live.world().parameters.dem;
  live_slider(live, {"Longest step", "dt_s", ranges.dt_low, ranges.dt_high, "s", kByPowers},
              live.chosen_dt(), controls);
  ImGui::TextDisabled("These start the scene again, from time 0:");
  const bool is_named = now.max_penetration > 0;
  restart_slider(live,
                 {"Overlap allowed", "max_penetration_m", ranges.penetration_low,
                  ranges.penetration_high, is_named ? "m" : "m (chosen)", kByPowers},
                 live.world().surfaces->chosen().max_penetration, controls);
  restart_slider(live,
                 {"Impact steps", "steps_per_contact", kFewestSteps, kMostSteps, "",
                  ImGuiSliderFlags_NoRoundToFormat, true},
                 now.steps_per_contact, controls);
  choice(live, "Integrator", "integrator", {"hybrid", "explicit"},
         now.rests_implicitly ? "hybrid" : "explicit", Effect::kRestarts, controls);
}

void draw_xpbd(LiveScene& live, const Ranges& ranges, Controls& controls) {
  live_slider(live, {"Frame", "dt_s", ranges.dt_low, ranges.dt_high, "s", kByPowers},
              live.chosen_dt(), controls);
  ImGui::TextDisabled("These start the scene again, from time 0:");
  restart_slider(live,
                 {"Substeps", "substeps", kFewestSubsteps, kMostSubsteps, "",
                  ImGuiSliderFlags_NoRoundToFormat, true},
                 live.world().parameters.xpbd.substeps, controls);
}

void draw_physics(LiveScene& live, const Ranges& ranges, Controls& controls) {
  heading("Physics");
  draw_gravity(live, controls);
  const dem::Method method = live.world().parameters.method;
  if (method == dem::Method::kXpbd) {
    draw_xpbd(live, ranges, controls);
  } else if (method == dem::Method::kDem) {
    draw_dem(live, ranges, controls);
  } else {
    draw_seed(live, ranges, controls);
  }
  choice(live, "Method", "method", physics_key("method").choices,
         std::string(dem::to_string(live.scene().physics.method)), Effect::kRestarts, controls);
}

void save(LiveScene& live, Controls& controls) {
  controls.note.clear();
  controls.problem.clear();
  try {
    const auto file = save_scene(live.scene().file, live.changes().overrides());
    controls.note = "Saved " + file.filename().string();
  } catch (const scene::SceneError& error) {
    controls.problem = error.what();
  } catch (const ViewError& error) {
    controls.problem = error.what();
  }
}

void draw_changes(LiveScene& live, Controls& controls) {
  heading("Changed");
  const std::string line = live.changes().command_line();
  ImGui::PushTextWrapPos(0);
  if (line.empty()) {
    ImGui::TextDisabled("Nothing yet. What you change appears here, ready for the command line.");
  } else {
    ImGui::TextUnformatted(live.changes().lines().c_str());
  }
  ImGui::PopTextWrapPos();
  ImGui::BeginDisabled(line.empty());
  if (wide_button("Copy", 3)) {
    ImGui::SetClipboardText(line.c_str());
    controls.note = "Copied";
  }
  ImGui::SameLine();
  if (wide_button("Save scene", 3)) save(live, controls);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("To a new file beside the scene");
  ImGui::SameLine();
  if (wide_button("Undo", 3)) controls.problem = live.undo_changes();
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Back to the start, from time 0");
  ImGui::EndDisabled();
}

}  // namespace

Ranges ranges_of(const scene::BuiltScene& built) {
  constexpr double kDecades = 1000, kSteps = 30, kFinest = 10, kFrames = 2;
  constexpr double kLeastOverlap = 1e-5, kMostOverlap = 0.05;  // of the smallest free body
  Ranges ranges{built.world.seed.stiffness / kDecades,
                built.world.seed.stiffness * kDecades,
                built.world.dt / kSteps,
                built.world.dt * (dem::has_surfaces(built.world.method) ? kFrames : kSteps),
                0,
                0,
                0,
                0,
                built.world.method};
  double smallest = 0;
  for (const dem::BodyDefinition& body : built.world.bodies) {
    if (body.motion == dem::Motion::kFree && (smallest == 0 || body.size < smallest)) {
      smallest = body.size;
    }
    if (body.particle_offsets_b.size() <= 1) continue;  // a ball is one particle whatever is set
    const double high = ranges.particle_size_high;
    ranges.particle_size_high = high > 0 ? std::min(high, body.size) : body.size;
  }
  ranges.particle_size_low = ranges.particle_size_high / kFinest;
  ranges.penetration_low = kLeastOverlap * smallest;
  ranges.penetration_high = kMostOverlap * smallest;
  return ranges;
}

void draw_live_panel(const Fonts& fonts, LiveScene& live, const RateMeter& meter,
                     const Ranges& ranges, Controls& controls) {
  begin_side_panel(fonts, live.scene().name);
  draw_transport(live, controls);
  draw_readings(live, meter, controls);
  draw_view_controls(controls, !live.world().surfaces);
  draw_physics(live, ranges, controls);
  draw_changes(live, controls);
  draw_messages(controls);
  ImGui::End();
}

}  // namespace verisim::view
