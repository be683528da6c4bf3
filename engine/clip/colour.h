// SPDX-License-Identifier: MIT
// RGBA pictures to video planes: BT.709, limited range, 4:2:0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace verisim::clip {

/// Three planes of a 4:2:0 picture, top row first; strides in bytes.
struct PlanesI420 {
  std::uint8_t* y;
  std::uint8_t* u;
  std::uint8_t* v;
  std::ptrdiff_t y_stride, u_stride, v_stride;
};

/// Converts rows that run from the bottom up (as OpenGL reads them) to rows that run from the top
/// down. width, height: even. rgba: 4 * width * height bytes; alpha is ignored. Chroma is the mean
/// of 2x2 pixels, so it sits in their middle. Rounds to nearest; within 1 of exact arithmetic.
/// Source: ITU-R BT.709-6, items 3.2 to 3.5, quantised to 8 bits.
void rgba_to_i420(std::span<const std::uint8_t> rgba, int width, int height,
                  const PlanesI420& planes);

/// The inverse, for tests and stills: rows from the top down, alpha 255, chroma repeated.
void i420_to_rgba(const PlanesI420& planes, int width, int height, std::span<std::uint8_t> rgba);

}  // namespace verisim::clip
