// SPDX-License-Identifier: MIT
#include "view/theme.h"

#include <filesystem>
#include <string>

namespace verisim::view {
namespace {

ImFont* load_font(const char* name, float size) {
  const std::string file = std::string("/usr/share/fonts/truetype/dejavu/") + name;
  ImFontAtlas* fonts = ImGui::GetIO().Fonts;
  if (!std::filesystem::exists(file)) return fonts->AddFontDefault();
  return fonts->AddFontFromFileTTF(file.c_str(), size);
}

void set_colours(ImVec4* colours) {
  const ImVec4 ground(0.105F, 0.115F, 0.130F, 1), raised(0.17F, 0.185F, 0.21F, 1),
      hovered(0.23F, 0.255F, 0.29F, 1);
  const auto accent = [](float strength) {
    return ImVec4(kAccent.x, kAccent.y, kAccent.z, strength);
  };
  colours[ImGuiCol_Text] = ImVec4(0.92F, 0.93F, 0.94F, 1);
  colours[ImGuiCol_TextDisabled] = kQuietText;
  colours[ImGuiCol_WindowBg] = ground;
  colours[ImGuiCol_PopupBg] = ground;
  colours[ImGuiCol_Border] = ImVec4(1, 1, 1, 0.08F);
  colours[ImGuiCol_FrameBg] = raised;
  colours[ImGuiCol_FrameBgHovered] = hovered;
  colours[ImGuiCol_FrameBgActive] = hovered;
  colours[ImGuiCol_Button] = raised;
  colours[ImGuiCol_ButtonHovered] = hovered;
  colours[ImGuiCol_ButtonActive] = accent(0.55F);
  colours[ImGuiCol_SliderGrab] = accent(0.60F);
  colours[ImGuiCol_SliderGrabActive] = accent(0.85F);
  colours[ImGuiCol_CheckMark] = accent(1);
  colours[ImGuiCol_Header] = accent(0.30F);
  colours[ImGuiCol_HeaderHovered] = accent(0.45F);
  colours[ImGuiCol_HeaderActive] = accent(0.55F);
  colours[ImGuiCol_Separator] = ImVec4(1, 1, 1, 0.10F);
}

}  // namespace

Fonts apply_theme() {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowPadding = ImVec2(16, 14);
  style.FramePadding = ImVec2(8, 4);
  style.ItemSpacing = ImVec2(8, 6);
  style.ItemInnerSpacing = ImVec2(8, 4);
  style.FrameRounding = 4;
  style.GrabRounding = 3;
  style.GrabMinSize = 7;  // narrow, so that the number stays readable
  style.WindowRounding = 6;
  style.PopupRounding = 4;
  style.WindowBorderSize = 0;
  style.ScrollbarSize = 10;
  set_colours(style.Colors);
  return {load_font("DejaVuSans.ttf", 14), load_font("DejaVuSans-Bold.ttf", 18)};
}

}  // namespace verisim::view
