// SPDX-License-Identifier: MIT
// Which tiles of the picture some convex outlines touch, so that each tile is shaded once however
// many outlines overlap there.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace verisim::render {

class TileMask {
 public:
  TileMask(int width, int height);  // px

  void clear();
  void mark_all();
  /// Marks all tiles that a convex outline touches. points: px from the bottom left, in order.
  void mark(std::span<const glm::vec2> points);
  /// Corners of triangles (three each, px) that cover the marked tiles once.
  std::vector<glm::vec2> triangles() const;

 private:
  static constexpr int kTile = 16;  // px; a software rasteriser fills aligned 16x16 blocks fastest

  int columns_, rows_;
  std::vector<char> is_marked_;  // [row][column]
};

}  // namespace verisim::render
