// SPDX-License-Identifier: MIT
// The renderer's own pictures: four samples per pixel, the still background, and the result.
#pragma once

#include <cstdint>
#include <span>

#include "render/gl_objects.h"
#include "render/view.h"

namespace verisim::render {

constexpr int kSamples = 4;

/// Colour and depth with exactly four samples, a copy of the background, one resolved picture.
class Framebuffer {
 public:
  /// Throws RenderError if the driver does not give exactly four samples.
  Framebuffer(const Gl& gl, int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  PixelRect all() const { return {0, 0, width_, height_}; }
  void bind_background() const;
  /// Starts a picture: the background's colours inside `area`, an empty depth buffer everywhere.
  void start_from_background(const PixelRect& area) const;
  /// Averages the samples into the result, inside `area`.
  void resolve(const PixelRect& area) const;
  /// Copies the resolved result into another framebuffer object, 0 = the window, of the same size.
  void copy_to(GLuint target) const;
  /// Rows from the bottom up, RGBA, 4 * width * height bytes.
  void read(std::span<std::uint8_t> rgba) const;

 private:
  void copy_colour(GLuint from, GLuint to, const PixelRect& area) const;

  const Gl* gl_;
  int width_, height_;
  GlRenderbuffer colour_, depth_, background_colour_, result_colour_;
  GlFramebuffer picture_, background_, result_;
};

}  // namespace verisim::render
