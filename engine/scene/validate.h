// SPDX-License-Identifier: MIT
// Checks a scene document against the key table: form only, not meaning.
#pragma once

#include <optional>
#include <vector>

#include "scene/document.h"

namespace verisim::scene {

/// Unknown and missing keys, wrong kinds, numbers out of bounds: all of them, in file order.
std::vector<Problem> validate(const Document& document);

/// The number written in a scalar, exactly; no trailing text. Empty when it is none.
std::optional<double> parse_number(const YAML::Node& node);

}  // namespace verisim::scene
