// SPDX-License-Identifier: MIT
// JSON Schema of the scene format, generated from the key table so that editors complete scenes.
#pragma once

#include <string>

namespace verisim::scene {

/// JSON Schema (draft 2020-12) of a scene file, indented, ends with a newline.
std::string scene_schema();

}  // namespace verisim::scene
