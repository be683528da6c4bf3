// SPDX-License-Identifier: MIT
// Off-screen pictures with four samples.
#include "render/framebuffer.h"

#include <string>

#include "render/render_error.h"

namespace verisim::render {
namespace {

GlRenderbuffer make_storage(const Gl& gl, GLenum format, int samples, int width, int height) {
  GlRenderbuffer buffer(gl);
  gl.BindRenderbuffer(GL_RENDERBUFFER, buffer.id());
  gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
  GLint given = 0;
  gl.GetRenderbufferParameteriv(GL_RENDERBUFFER, GL_RENDERBUFFER_SAMPLES, &given);
  if (given != samples) {
    // A driver may give more than asked; the pixels would then differ from other machines'.
    throw RenderError("the OpenGL driver gives " + std::to_string(given) +
                      " samples per pixel where " + std::to_string(samples) + " were asked");
  }
  return buffer;
}

GlFramebuffer make_framebuffer(const Gl& gl, const GlRenderbuffer& colour,
                               const GlRenderbuffer* depth) {
  GlFramebuffer framebuffer(gl);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour.id());
  if (depth != nullptr) {
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth->id());
  }
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw RenderError("the OpenGL driver refuses a four-sample picture of this size");
  }
  return framebuffer;
}

}  // namespace

Framebuffer::Framebuffer(const Gl& gl, int width, int height)
    : gl_(&gl),
      width_(width),
      height_(height),
      colour_(make_storage(gl, GL_RGBA8, kSamples, width, height)),
      depth_(make_storage(gl, GL_DEPTH_COMPONENT24, kSamples, width, height)),
      background_colour_(make_storage(gl, GL_RGBA8, kSamples, width, height)),
      result_colour_(make_storage(gl, GL_RGBA8, 0, width, height)),
      picture_(make_framebuffer(gl, colour_, &depth_)),
      background_(make_framebuffer(gl, background_colour_, nullptr)),
      result_(make_framebuffer(gl, result_colour_, nullptr)) {}

void Framebuffer::bind_background() const {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, background_.id());
  gl_->Viewport(0, 0, width_, height_);
}

void Framebuffer::copy_colour(GLuint from, GLuint to, const PixelRect& area) const {
  if (area.left >= area.right || area.bottom >= area.top) return;
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, from);
  gl_->BindFramebuffer(GL_DRAW_FRAMEBUFFER, to);
  gl_->BlitFramebuffer(area.left, area.bottom, area.right, area.top, area.left, area.bottom,
                       area.right, area.top, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void Framebuffer::start_from_background(const PixelRect& area) const {
  copy_colour(background_.id(), picture_.id(), area);
  gl_->BindFramebuffer(GL_FRAMEBUFFER, picture_.id());
  gl_->Viewport(0, 0, width_, height_);
  gl_->Clear(GL_DEPTH_BUFFER_BIT);
}

void Framebuffer::resolve(const PixelRect& area) const {
  copy_colour(picture_.id(), result_.id(), area);
}

void Framebuffer::copy_to(GLuint target) const { copy_colour(result_.id(), target, all()); }

void Framebuffer::read(std::span<std::uint8_t> rgba) const {
  gl_->BindFramebuffer(GL_READ_FRAMEBUFFER, result_.id());
  gl_->PixelStorei(GL_PACK_ALIGNMENT, 4);
  gl_->ReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
}

}  // namespace verisim::render
