// SPDX-License-Identifier: MIT
// Looks up the OpenGL functions of the current context.
#include "render/gl_functions.h"

#include "render/render_error.h"

namespace verisim::render {

Gl load_gl(const GetProcAddress& get_proc_address) {
  Gl gl;
  std::string missing;
#define VERISIM_GL_LOAD(name, type)                               \
  gl.name = reinterpret_cast<type>(get_proc_address("gl" #name)); \
  if (gl.name == nullptr) missing += " gl" #name;
  VERISIM_GL_FUNCTIONS(VERISIM_GL_LOAD)
#undef VERISIM_GL_LOAD
  if (!missing.empty()) {
    throw RenderError("this OpenGL lacks functions of version 3.3:" + missing +
                      "\nhint: try another --gl backend, or update the graphics driver");
  }
  return gl;
}

}  // namespace verisim::render
