// SPDX-License-Identifier: MIT
// What panels are put together from.
#pragma once

#include <imgui.h>

#include <string>

#include "view/panels.h"

namespace verisim::view {

/// Starts the panel at the right edge with the scene's name as title; ImGui::End() ends it.
void begin_side_panel(const Fonts& fonts, const std::string& title);
/// A small heading with space above.
void heading(const char* words);
/// A row of two columns inside of a table.
void reading(const char* name, const std::string& value, const ImVec4* colour = nullptr);
bool begin_readings();
/// The label of a control, at the left of the same line.
void label(const char* words, const char* explanation);
// The same for runs and pose logs: slow motion; particles, camera and help; what was done or why
// not.
void draw_speed_row(Controls& controls);
void draw_view_controls(Controls& controls, bool has_particles);
void draw_messages(const Controls& controls);
/// Text by printf's rules.
std::string text_of(const char* format, double value);
/// A button as wide as a share of the panel; `share` of 3 is a third.
bool wide_button(const char* words, int share);

}  // namespace verisim::view
