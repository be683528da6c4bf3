// SPDX-License-Identifier: MIT
// How the panels look: colours, spacing, fonts.
#pragma once

#include <imgui.h>

namespace verisim::view {

constexpr float kPanelWidth = 348;  // units

// Colours with a meaning.
const ImVec4 kQuietText(0.60F, 0.63F, 0.67F, 1);
const ImVec4 kWarning(0.98F, 0.74F, 0.30F, 1);
const ImVec4 kAlarm(0.72F, 0.16F, 0.15F, 0.96F);
const ImVec4 kAccent(0.36F, 0.62F, 0.88F, 1);

struct Fonts {
  ImFont* text = nullptr;
  ImFont* title = nullptr;
};

/// Sets colours and spacing, and loads DejaVu Sans where Debian keeps it; without it Dear ImGui's
/// built-in font serves for both. Call once, after ImGui::CreateContext.
Fonts apply_theme();

}  // namespace verisim::view
