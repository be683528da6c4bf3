// SPDX-License-Identifier: MIT
#include "scene/problem.h"

namespace verisim::scene {

std::string describe(const std::vector<Problem>& problems) {
  std::string text;
  for (const Problem& problem : problems) {
    if (!text.empty()) text += '\n';
    text += problem.where + ": " + problem.key;
    if (!problem.seen.empty()) text += ": saw " + problem.seen;
    if (!problem.allowed.empty()) text += "; allowed: " + problem.allowed;
    if (!problem.hint.empty()) text += "\n  hint: " + problem.hint;
  }
  return text;
}

}  // namespace verisim::scene
