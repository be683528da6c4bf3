// SPDX-License-Identifier: MIT
// What lies over the picture: the failure banner and the keys.
#include <imgui.h>

#include "view/panel_parts.h"

namespace verisim::view {
namespace {

constexpr float kMargin = 14;  // units
constexpr ImGuiWindowFlags kOverlay = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_AlwaysAutoResize |
                                      ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;

void key_row(const char* keys, const char* effect) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(keys);
  ImGui::TableNextColumn();
  ImGui::TextDisabled("%s", effect);
}

}  // namespace

void draw_failure_banner(const dem::Failure& failure, bool stopped) {
  const float width = ImGui::GetIO().DisplaySize.x - kPanelWidth - 2 * kMargin;
  ImGui::SetNextWindowPos(ImVec2(kMargin, kMargin));
  ImGui::SetNextWindowSize(ImVec2(width, 0));
  ImGui::PushStyleColor(ImGuiCol_WindowBg, kAlarm);
  ImGui::Begin("##failure", nullptr, kOverlay & ~ImGuiWindowFlags_AlwaysAutoResize);
  const std::string body = failure.body.empty() ? "" : ", body " + failure.body;
  ImGui::Text("FAILED: %s%s, step %ld, %.4f s", failure.code.c_str(), body.c_str(), failure.step,
              failure.time);
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted((failure.message + (stopped ? ". Restart to go on." : ".")).c_str());
  ImGui::PopTextWrapPos();
  ImGui::End();
  ImGui::PopStyleColor();
}

void draw_help(bool is_player) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2((size.x - kPanelWidth) / 2, size.y / 2), ImGuiCond_Always,
                          ImVec2(0.5F, 0.5F));
  ImGui::SetNextWindowBgAlpha(0.94F);
  ImGui::Begin("##help", nullptr, kOverlay);
  if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
    if (!is_player) key_row("drag a body", "pull it by a spring");
    key_row("drag elsewhere, or middle button", "turn about the scene");
    key_row("Shift + drag", "move sideways");
    key_row("wheel", "nearer, farther");
    key_row("right button + W A S D, Q E", "look and fly; Shift is faster");
    key_row("Space", is_player ? "play, pause" : "run, pause");
    if (is_player) {
      key_row("Left, Right", "one frame back, on");
      key_row("Home, End", "first frame, last");
    } else {
      key_row(".", "one time step");
      key_row("Right", "one frame of the clip");
      key_row("R", "restart from time 0");
    }
    key_row("Down, Up", "slower, faster");
    key_row("P", "particles or surfaces");
    key_row("C", "reset camera");
    key_row("H", "these keys");
    ImGui::EndTable();
  }
  ImGui::End();
}

}  // namespace verisim::view
