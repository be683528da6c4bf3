// SPDX-License-Identifier: MIT
#include "view/panel_parts.h"

#include <cstdio>

namespace verisim::view {
namespace {

constexpr float kLabelWidth = 112;  // units
constexpr const char* kSpeedNames[kSlowest + 1] = {"1x", "1/2", "1/4", "1/8", "1/16", "1/32"};

}  // namespace

std::string text_of(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

void begin_side_panel(const Fonts& fonts, const std::string& title) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(size.x - kPanelWidth, 0));
  ImGui::SetNextWindowSize(ImVec2(kPanelWidth, size.y));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
  ImGui::Begin("##side", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
  ImGui::PopStyleVar();
  ImGui::PushFont(fonts.title);
  ImGui::TextUnformatted(title.c_str());
  ImGui::PopFont();
}

void heading(const char* words) {
  ImGui::Dummy(ImVec2(0, 2));
  ImGui::Separator();
  ImGui::PushStyleColor(ImGuiCol_Text, kAccent);
  ImGui::TextUnformatted(words);
  ImGui::PopStyleColor();
}

bool begin_readings() {
  if (!ImGui::BeginTable("readings", 2)) return false;
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthFixed, kLabelWidth);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch);
  return true;
}

void reading(const char* name, const std::string& value, const ImVec4* colour) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextDisabled("%s", name);
  ImGui::TableNextColumn();
  if (colour != nullptr) ImGui::PushStyleColor(ImGuiCol_Text, *colour);
  ImGui::TextUnformatted(value.c_str());
  if (colour != nullptr) ImGui::PopStyleColor();
}

void label(const char* words, const char* explanation) {
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("%s", words);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", explanation);
  ImGui::SameLine(ImGui::GetStyle().WindowPadding.x + kLabelWidth);
  ImGui::SetNextItemWidth(-1);
}

bool wide_button(const char* words, int share) {
  const float gaps = ImGui::GetStyle().ItemSpacing.x * static_cast<float>(share - 1);
  const float room = ImGui::GetWindowContentRegionMax().x - ImGui::GetWindowContentRegionMin().x;
  return ImGui::Button(words, ImVec2((room - gaps) / static_cast<float>(share), 0));
}

void draw_speed_row(Controls& controls) {
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(4, 6));
  for (int i = 0; i <= kSlowest; ++i) {
    if (i > 0) ImGui::SameLine();
    const bool is_chosen = controls.slow_motion == i;
    if (is_chosen) {
      ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    }
    if (wide_button(kSpeedNames[i], kSlowest + 1)) controls.slow_motion = i;
    if (is_chosen) ImGui::PopStyleColor();
  }
  ImGui::PopStyleVar();
}

void draw_view_controls(Controls& controls, bool has_particles) {
  ImGui::BeginDisabled(!has_particles);
  ImGui::Checkbox("Particles", &controls.show_particles);
  ImGui::EndDisabled();
  ImGui::SameLine(0, 18);
  if (ImGui::Button("Reset camera")) controls.reset_camera = true;
  ImGui::SameLine();
  if (ImGui::Button("Keys")) controls.show_help = !controls.show_help;
}

void draw_messages(const Controls& controls) {
  ImGui::PushTextWrapPos(0);
  if (!controls.note.empty()) ImGui::TextDisabled("%s", controls.note.c_str());
  if (!controls.problem.empty()) ImGui::TextColored(kWarning, "%s", controls.problem.c_str());
  ImGui::PopTextWrapPos();
}

}  // namespace verisim::view
