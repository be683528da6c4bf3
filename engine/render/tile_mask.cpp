// SPDX-License-Identifier: MIT
// Marks tiles row by row.
#include "render/tile_mask.h"

#include <algorithm>
#include <cmath>

namespace verisim::render {

TileMask::TileMask(int width, int height)
    : columns_((width + kTile - 1) / kTile),
      rows_((height + kTile - 1) / kTile),
      is_marked_(static_cast<std::size_t>(columns_) * rows_) {}

void TileMask::clear() { std::fill(is_marked_.begin(), is_marked_.end(), 0); }

void TileMask::mark_all() { std::fill(is_marked_.begin(), is_marked_.end(), 1); }

void TileMask::mark(std::span<const glm::vec2> points) {
  for (int row = 0; row < rows_; ++row) {
    // The outline's extent in x within this row of tiles: from its edges, cut to the row.
    const float bottom = static_cast<float>(row * kTile), top = bottom + kTile;
    float low = INFINITY, high = -INFINITY;
    for (std::size_t i = 0; i < points.size(); ++i) {
      glm::vec2 a = points[i], b = points[(i + 1) % points.size()];
      if (a.y > b.y) std::swap(a, b);
      if (b.y < bottom || a.y > top) continue;
      const float slope = b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0;
      const float start = a.y < bottom ? a.x + slope * (bottom - a.y) : a.x;
      const float end = b.y > top ? a.x + slope * (top - a.y) : b.x;
      low = std::min({low, start, end});
      high = std::max({high, start, end});
    }
    const float last = static_cast<float>(columns_ * kTile - 1);
    if (!(low <= high) || high < 0 || low > last) continue;
    const int first_column = static_cast<int>(std::max(low, 0.0F)) / kTile;
    const int last_column = static_cast<int>(std::min(high, last)) / kTile;
    for (int column = first_column; column <= last_column; ++column) {
      is_marked_[static_cast<std::size_t>(row) * columns_ + column] = 1;
    }
  }
}

std::vector<glm::vec2> TileMask::triangles() const {
  std::vector<glm::vec2> corners;
  for (int row = 0; row < rows_; ++row) {
    const char* marks = is_marked_.data() + static_cast<std::size_t>(row) * columns_;
    for (int start = 0; start < columns_; ++start) {
      if (!marks[start]) continue;
      int end = start;
      while (end < columns_ && marks[end]) ++end;
      const glm::vec2 low(start * kTile, row * kTile), high(end * kTile, (row + 1) * kTile);
      const glm::vec2 left_top(low.x, high.y), right_bottom(high.x, low.y);
      corners.insert(corners.end(), {low, right_bottom, high, low, high, left_top});
      start = end;
    }
  }
  return corners;
}

}  // namespace verisim::render
