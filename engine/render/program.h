// SPDX-License-Identifier: MIT
// A linked shader program and its uniforms.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <string_view>

#include "render/gl_functions.h"

namespace verisim::render {

/// Compiles and links on construction. Throws RenderError with the driver's log.
class Program {
 public:
  Program(const Gl& gl, std::string_view vertex_source, std::string_view fragment_source);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();

  void use() const;
  /// Sets a uniform of the program in use; a name that the compiler dropped is ignored, as in GL.
  void set(const char* name, int value) const;
  void set(const char* name, float value) const;
  void set(const char* name, const glm::vec2& value) const;
  void set(const char* name, const glm::vec3& value) const;
  void set(const char* name, const glm::vec4& value) const;
  void set(const char* name, const glm::mat3& value) const;
  void set(const char* name, const glm::mat4& value) const;

 private:
  GLuint compile(GLenum stage, std::string_view source) const;

  const Gl& gl_;
  GLuint id_ = 0;
};

}  // namespace verisim::render
