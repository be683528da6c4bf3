// SPDX-License-Identifier: MIT
// Owners of GL names: each deletes its object when it goes.
#pragma once

#include <utility>

#include "render/gl_functions.h"

namespace verisim::render {

/// Move-only owner of one GL name. The context must still be current when it is destroyed.
template <auto Generate, auto Delete>
class GlObject {
 public:
  GlObject() = default;
  explicit GlObject(const Gl& gl) : gl_(&gl) { (gl.*Generate)(1, &id_); }
  GlObject(GlObject&& other) noexcept
      : gl_(std::exchange(other.gl_, nullptr)), id_(std::exchange(other.id_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(gl_, other.gl_);
    std::swap(id_, other.id_);
    return *this;
  }
  ~GlObject() {
    if (id_ != 0) (gl_->*Delete)(1, &id_);
  }
  GLuint id() const { return id_; }

 private:
  const Gl* gl_ = nullptr;
  GLuint id_ = 0;
};

using GlBuffer = GlObject<&Gl::GenBuffers, &Gl::DeleteBuffers>;
using GlVertexArray = GlObject<&Gl::GenVertexArrays, &Gl::DeleteVertexArrays>;
using GlTexture = GlObject<&Gl::GenTextures, &Gl::DeleteTextures>;
using GlRenderbuffer = GlObject<&Gl::GenRenderbuffers, &Gl::DeleteRenderbuffers>;
using GlFramebuffer = GlObject<&Gl::GenFramebuffers, &Gl::DeleteFramebuffers>;

}  // namespace verisim::render
