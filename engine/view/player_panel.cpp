// SPDX-License-Identifier: MIT
// The panel of a pose log, and its time line under the picture.
#include <imgui.h>

#include <cstdio>

#include "view/panel_parts.h"

namespace verisim::view {
namespace {

void draw_time_line(PosePlayer& player, Controls& controls) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  constexpr float kHeight = 52, kMargin = 14;
  ImGui::SetNextWindowPos(ImVec2(kMargin, size.y - kHeight - kMargin));
  ImGui::SetNextWindowSize(ImVec2(size.x - kPanelWidth - 2 * kMargin, kHeight));
  ImGui::SetNextWindowBgAlpha(0.92F);
  ImGui::Begin("##time", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
  if (ImGui::Button(controls.running ? "Pause" : "Play", ImVec2(64, 0))) {
    controls.running = !controls.running;
  }
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  int frame = player.frame();
  char format[48];
  std::snprintf(format, sizeof format, "frame %%d  -  %.3f s", player.time());
  if (ImGui::SliderInt("##frame", &frame, 0, player.num_frames() - 1, format)) {
    player.seek(frame);
    controls.running = false;
  }
  ImGui::End();
}

}  // namespace

void draw_player_panel(const Fonts& fonts, const std::string& scene_name, PosePlayer& player,
                       const RateMeter& meter, bool has_particles, Controls& controls) {
  begin_side_panel(fonts, scene_name);
  ImGui::PushTextWrapPos(0);
  ImGui::TextDisabled("A recorded run: poses from a log, nothing is simulated.");
  ImGui::PopTextWrapPos();
  const auto stop_and = [&](int frame) {
    player.seek(frame);
    controls.running = false;
  };
  if (wide_button("Back", 3)) stop_and(player.frame() - 1);
  ImGui::SameLine();
  if (wide_button("Forward", 3)) stop_and(player.frame() + 1);
  ImGui::SameLine();
  if (wide_button("To start", 3)) stop_and(0);
  draw_speed_row(controls);
  if (begin_readings()) {
    reading("Time", text_of("%.3f s", player.time()));
    reading("Ends at", text_of("%.3f s", player.end()));
    reading("Frame",
            std::to_string(player.frame()) + " of " + std::to_string(player.num_frames() - 1));
    reading("Frame rate", text_of("%.0f / s", meter.frames_per_second()));
    ImGui::EndTable();
  }
  draw_view_controls(controls, has_particles);
  draw_messages(controls);
  ImGui::End();
  draw_time_line(player, controls);
}

}  // namespace verisim::view
