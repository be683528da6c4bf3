// SPDX-License-Identifier: MIT
// What is wrong with an input file: where, what was seen, what is allowed, and a hint.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace verisim::scene {

struct Problem {
  std::string where;    // file:line, or the override's own text
  std::string key;      // dotted path, e.g. bodies.fox.position_m
  std::string seen;     // the value as written
  std::string allowed;  // what would be right
  std::string hint;     // the reader's next step; may be empty
};

/// One line per problem, then its hint, in file order.
std::string describe(const std::vector<Problem>& problems);

/// Every problem of one scene at once.
class SceneError : public std::runtime_error {
 public:
  explicit SceneError(std::vector<Problem> found)
      : std::runtime_error(describe(found)), problems(std::move(found)) {}
  std::vector<Problem> problems;
};

}  // namespace verisim::scene
