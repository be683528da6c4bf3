// SPDX-License-Identifier: MIT
// Compiles, links and feeds shader programs.
#include "render/program.h"

#include <array>
#include <glm/gtc/type_ptr.hpp>

#include "render/render_error.h"

namespace verisim::render {

Program::Program(const Gl& gl, std::string_view vertex_source, std::string_view fragment_source)
    : gl_(gl) {
  const GLuint vertex = compile(GL_VERTEX_SHADER, vertex_source);
  const GLuint fragment = compile(GL_FRAGMENT_SHADER, fragment_source);
  id_ = gl_.CreateProgram();
  gl_.AttachShader(id_, vertex);
  gl_.AttachShader(id_, fragment);
  gl_.LinkProgram(id_);
  gl_.DeleteShader(vertex);
  gl_.DeleteShader(fragment);
  GLint linked = 0;
  gl_.GetProgramiv(id_, GL_LINK_STATUS, &linked);
  if (!linked) {
    std::array<char, 2048> log{};
    gl_.GetProgramInfoLog(id_, log.size(), nullptr, log.data());
    gl_.DeleteProgram(id_);
    throw RenderError(std::string("shader program does not link: ") + log.data());
  }
}

Program::~Program() { gl_.DeleteProgram(id_); }

GLuint Program::compile(GLenum stage, std::string_view source) const {
  const GLuint shader = gl_.CreateShader(stage);
  const char* text = source.data();
  const GLint length = static_cast<GLint>(source.size());
  gl_.ShaderSource(shader, 1, &text, &length);
  gl_.CompileShader(shader);
  GLint compiled = 0;
  gl_.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (!compiled) {
    std::array<char, 2048> log{};
    gl_.GetShaderInfoLog(shader, log.size(), nullptr, log.data());
    gl_.DeleteShader(shader);
    throw RenderError(std::string("shader does not compile: ") + log.data());
  }
  return shader;
}

void Program::use() const { gl_.UseProgram(id_); }

void Program::set(const char* name, int value) const {
  gl_.Uniform1i(gl_.GetUniformLocation(id_, name), value);
}
void Program::set(const char* name, float value) const {
  gl_.Uniform1f(gl_.GetUniformLocation(id_, name), value);
}
void Program::set(const char* name, const glm::vec2& v) const {
  gl_.Uniform2f(gl_.GetUniformLocation(id_, name), v.x, v.y);
}
void Program::set(const char* name, const glm::vec3& v) const {
  gl_.Uniform3f(gl_.GetUniformLocation(id_, name), v.x, v.y, v.z);
}
void Program::set(const char* name, const glm::vec4& v) const {
  gl_.Uniform4f(gl_.GetUniformLocation(id_, name), v.x, v.y, v.z, v.w);
}
void Program::set(const char* name, const glm::mat3& value) const {
  gl_.UniformMatrix3fv(gl_.GetUniformLocation(id_, name), 1, GL_FALSE, glm::value_ptr(value));
}
void Program::set(const char* name, const glm::mat4& value) const {
  gl_.UniformMatrix4fv(gl_.GetUniformLocation(id_, name), 1, GL_FALSE, glm::value_ptr(value));
}

}  // namespace verisim::render
