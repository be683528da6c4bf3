// SPDX-License-Identifier: MIT
// The table of every key a scene may hold. Validation, the JSON Schema and the documentation
// are all generated from it, so they cannot disagree.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace verisim::scene {

enum class Kind {
  kNumber,
  kInteger,
  kText,        // any non-empty string
  kIdentifier,  // letters, digits, '_' and '-': used in file names
  kPath,        // relative to the scene file
  kVector,      // list of exactly `length` numbers
  kChoice,      // one of `choices`
  kMap,         // fixed keys: `children`
  kNamedMap,    // free names, each a map of `children`
  kList,        // list of maps of `children`
  kNameList,    // list of names
  kChoiceOrMap  // one of `choices`, or a map of `children`
};

struct Key {
  std::string name;
  Kind kind;
  bool required = false;
  std::string description;
  std::string default_text = {};        // as it would be written; documentation only
  std::optional<double> above = {};     // exclusive lower bound of each number
  std::optional<double> at_least = {};  // inclusive lower bound
  std::optional<double> at_most = {};   // inclusive upper bound
  int length = 0;                       // kVector
  std::vector<std::string> choices = {};
  std::vector<Key> children = {};
  bool exactly_one_of_required = false;  // kMap: exactly one of the children marked required
};

/// The root map of a scene file.
const Key& scene_keys();

/// What a value of this key may be, in words: "a number > 0".
std::string allowed_text(const Key& key);

}  // namespace verisim::scene
