// SPDX-License-Identifier: MIT
// Colour conversion against the standard's formula in double precision.
#include "clip/colour.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace verisim::clip {
namespace {

struct Planes {
  int width, height;
  std::vector<std::uint8_t> y, u, v;
  Planes(int w, int h) : width(w), height(h), y(w * h), u(w * h / 4), v(w * h / 4) {}
  PlanesI420 view() { return {y.data(), u.data(), v.data(), width, width / 2, width / 2}; }
};

struct Yuv {
  double y, u, v;
};

/// ITU-R BT.709-6, items 3.2 to 3.5, 8 bits.
Yuv exact(double r, double g, double b) {
  const double luma = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  return {16 + 219 * luma / 255, 128 + 224 * (b - luma) / 1.8556 / 255,
          128 + 224 * (r - luma) / 1.5748 / 255};
}

std::vector<std::uint8_t> random_pixels(int width, int height) {
  std::mt19937 rng(20);
  std::vector<std::uint8_t> rgba(4 * static_cast<std::size_t>(width) * height);
  for (std::uint8_t& byte : rgba) byte = static_cast<std::uint8_t>(rng());
  return rgba;
}

}  // namespace

TEST_CASE("conversion_agrees_with_the_standard") {
  constexpr int kWidth = 62, kHeight = 48;  // no multiple of a vector's length
  const std::vector<std::uint8_t> rgba = random_pixels(kWidth, kHeight);
  Planes planes(kWidth, kHeight);
  rgba_to_i420(rgba, kWidth, kHeight, planes.view());
  double worst_luma = 0, worst_chroma = 0;
  const auto at = [&](int x, int row) {  // row from the top
    return &rgba[4 * (static_cast<std::size_t>(kHeight - 1 - row) * kWidth + x)];
  };
  for (int row = 0; row < kHeight; ++row) {
    for (int x = 0; x < kWidth; ++x) {
      const std::uint8_t* p = at(x, row);
      worst_luma =
          std::max(worst_luma, std::abs(planes.y[row * kWidth + x] - exact(p[0], p[1], p[2]).y));
    }
  }
  for (int row = 0; row < kHeight / 2; ++row) {
    for (int x = 0; x < kWidth / 2; ++x) {
      double mean[3] = {0, 0, 0};
      for (int i = 0; i < 4; ++i) {
        for (int c = 0; c < 3; ++c) mean[c] += at(2 * x + i % 2, 2 * row + i / 2)[c] / 4.0;
      }
      const Yuv wanted = exact(mean[0], mean[1], mean[2]);
      const int index = row * kWidth / 2 + x;
      worst_chroma = std::max({worst_chroma, std::abs(planes.u[index] - wanted.u),
                               std::abs(planes.v[index] - wanted.v)});
    }
  }
  // Rounding alone gives 0.5; the fixed-point weights add at most 3 * 255 / 2^17 = 0.006.
  CHECK(worst_luma <= 0.506);
  CHECK(worst_chroma <= 0.506);
}

TEST_CASE("greys_stay_grey_and_ends_are_exact") {
  for (const int grey : {0, 1, 77, 128, 254, 255}) {
    std::vector<std::uint8_t> rgba(16 * 16 * 4, static_cast<std::uint8_t>(grey));
    Planes planes(16, 16);
    rgba_to_i420(rgba, 16, 16, planes.view());
    CHECK(planes.u[5] == 128);
    CHECK(planes.v[5] == 128);
    CHECK(planes.y[5] == std::lround(16 + 219 * grey / 255.0));
  }
}

TEST_CASE("the_bottom_row_comes_last") {
  std::vector<std::uint8_t> rgba(16 * 16 * 4, 0);
  std::fill(rgba.begin(), rgba.begin() + 2 * 16 * 4, std::uint8_t{255});  // two lowest rows
  Planes planes(16, 16);
  rgba_to_i420(rgba, 16, 16, planes.view());
  CHECK(planes.y.front() == 16);
  CHECK(planes.y.back() == 235);
}

TEST_CASE("there_and_back_changes_little") {
  Planes planes(32, 32);
  std::vector<std::uint8_t> rgba(32 * 32 * 4, 255), back(rgba.size());
  const std::uint8_t colour[3] = {200, 90, 40};
  for (std::size_t i = 0; i < rgba.size(); ++i) {
    if (i % 4 != 3) rgba[i] = colour[i % 4];
  }
  rgba_to_i420(rgba, 32, 32, planes.view());
  i420_to_rgba(planes.view(), 32, 32, back);
  for (std::size_t i = 0; i < rgba.size(); ++i) CHECK(std::abs(rgba[i] - back[i]) <= 2);
}

}  // namespace verisim::clip
