// SPDX-License-Identifier: MIT
// The GLSL sources, complete with version line.
#pragma once

#include <string>

namespace verisim::render {

std::string caster_vertex_shader();  // bodies seen from the sun: depth only
std::string caster_fragment_shader();
std::string body_vertex_shader();  // bodies seen from the camera
std::string body_fragment_shader();
std::string background_vertex_shader();    // one triangle over the whole picture
std::string background_fragment_shader();  // ground in full sun, and sky
std::string shadow_area_vertex_shader();   // patches of ground that may be in shadow
std::string shadow_area_fragment_shader();

}  // namespace verisim::render
