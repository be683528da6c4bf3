// SPDX-License-Identifier: MIT
// Colour conversion in 16-bit fixed point; plain loops that the compiler turns into vector code.
#include "clip/colour.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "clip/vector_clones.h"

namespace verisim::clip {
namespace {

// BT.709 luma weights; luma spans 219 steps above 16, chroma 224 around 128.
constexpr double kRed = 0.2126, kGreen = 0.7152, kBlue = 0.0722;
constexpr int kShift = 16;
constexpr std::int32_t kHalf = 1 << (kShift - 1);

constexpr std::int32_t fixed(double value) {
  return static_cast<std::int32_t>(value * (1 << kShift) + (value < 0 ? -0.5 : 0.5));
}

constexpr double kLuma = 219.0 / 255, kChroma = 224.0 / 255;
constexpr std::int32_t kYr = fixed(kLuma * kRed), kYg = fixed(kLuma * kGreen),
                       kYb = fixed(kLuma * kBlue);
constexpr double kToU = kChroma / (2 * (1 - kBlue)), kToV = kChroma / (2 * (1 - kRed));
constexpr std::int32_t kUr = fixed(-kRed * kToU), kUb = fixed((1 - kBlue) * kToU),
                       kUg = -kUr - kUb;  // greys stay exactly grey
constexpr std::int32_t kVr = fixed((1 - kRed) * kToV), kVb = fixed(-kBlue * kToV), kVg = -kVr - kVb;

VERISIM_VECTOR_CLONES
void convert_luma_row(const std::uint32_t* pixels, int width, std::uint8_t* y) {
  for (int x = 0; x < width; ++x) {
    const std::int32_t r = pixels[x] & 0xff, g = pixels[x] >> 8 & 0xff, b = pixels[x] >> 16 & 0xff;
    y[x] =
        static_cast<std::uint8_t>((kYr * r + kYg * g + kYb * b + (16 << kShift) + kHalf) >> kShift);
  }
}

/// upper, lower: two rows of pixels; u, v: half a row each.
VERISIM_VECTOR_CLONES
void convert_chroma_row(const std::uint32_t* upper, const std::uint32_t* lower, int half_width,
                        std::uint8_t* u, std::uint8_t* v) {
  constexpr int kShift4 = kShift + 2;  // the sum of four pixels is divided by four at the end
  constexpr std::int32_t kOffset = (128 << kShift4) + (1 << (kShift4 - 1));
  for (int x = 0; x < half_width; ++x) {
    // Red and blue are 16 bits apart: both are summed in one word without touching each other.
    const std::uint32_t a = upper[2 * x], b = upper[2 * x + 1], c = lower[2 * x],
                        d = lower[2 * x + 1];
    const std::uint32_t red_blue =
        (a & 0xff00ff) + (b & 0xff00ff) + (c & 0xff00ff) + (d & 0xff00ff);
    const auto green = static_cast<std::int32_t>((a >> 8 & 0xff) + (b >> 8 & 0xff) +
                                                 (c >> 8 & 0xff) + (d >> 8 & 0xff));
    const auto red = static_cast<std::int32_t>(red_blue & 0xffff);
    const auto blue = static_cast<std::int32_t>(red_blue >> 16);
    u[x] = static_cast<std::uint8_t>((kUr * red + kUg * green + kUb * blue + kOffset) >> kShift4);
    v[x] = static_cast<std::uint8_t>((kVr * red + kVg * green + kVb * blue + kOffset) >> kShift4);
  }
}

std::uint8_t to_byte(double value) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
}

}  // namespace

void rgba_to_i420(std::span<const std::uint8_t> rgba, int width, int height,
                  const PlanesI420& planes) {
  const std::size_t row_size = 4 * static_cast<std::size_t>(width);
  std::vector<std::uint32_t> rows(2 * static_cast<std::size_t>(width));
  std::uint32_t* const upper = rows.data();
  std::uint32_t* const lower = upper + width;
  for (int row = 0; row < height; row += 2) {
    const std::uint8_t* const source = rgba.data() + (height - 1 - row) * row_size;
    std::memcpy(upper, source, row_size);
    std::memcpy(lower, source - row_size, row_size);
    convert_luma_row(upper, width, planes.y + row * planes.y_stride);
    convert_luma_row(lower, width, planes.y + (row + 1) * planes.y_stride);
    convert_chroma_row(upper, lower, width / 2, planes.u + row / 2 * planes.u_stride,
                       planes.v + row / 2 * planes.v_stride);
  }
}

void i420_to_rgba(const PlanesI420& planes, int width, int height, std::span<std::uint8_t> rgba) {
  for (int row = 0; row < height; ++row) {
    for (int x = 0; x < width; ++x) {
      const double y = (planes.y[row * planes.y_stride + x] - 16) / kLuma;
      const double u = (planes.u[row / 2 * planes.u_stride + x / 2] - 128) / kToU;  // blue - luma
      const double v = (planes.v[row / 2 * planes.v_stride + x / 2] - 128) / kToV;  // red - luma
      std::uint8_t* const pixel = rgba.data() + 4 * (static_cast<std::size_t>(row) * width + x);
      pixel[0] = to_byte(y + v);
      pixel[1] = to_byte(y - (kRed * v + kBlue * u) / kGreen);
      pixel[2] = to_byte(y + u);
      pixel[3] = 255;
    }
  }
}

}  // namespace verisim::clip
