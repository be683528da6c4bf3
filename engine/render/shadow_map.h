// SPDX-License-Identifier: MIT
// The depth picture that the sun sees.
#pragma once

#include "render/gl_objects.h"

namespace verisim::render {

class ShadowMap {
 public:
  explicit ShadowMap(const Gl& gl);
  /// Texels each way; what the map held is lost if they change.
  void resize(int width, int height);
  /// Clears the map and makes it the target of drawing.
  void start() const;
  /// Makes it the texture of unit 0.
  void bind_texture() const;

 private:
  const Gl& gl_;
  int width_ = 0, height_ = 0;
  GlTexture depth_;
  GlFramebuffer framebuffer_;
};

}  // namespace verisim::render
