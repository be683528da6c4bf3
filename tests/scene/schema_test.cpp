// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <fstream>
#include <sstream>

#include "scene/schema.h"

TEST_CASE("the_committed_json_schema_is_current") {
  std::ifstream stream(VERISIM_SOURCE_DIR "/stimuli/schema/scene.json");
  std::stringstream text;
  text << stream.rdbuf();
  // Write it again with: .ci/write-schemas
  CHECK(text.str() == verisim::scene::scene_schema());
}
