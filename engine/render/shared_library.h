// SPDX-License-Identifier: MIT
// Opens a shared library at run time and looks up functions in it.
#pragma once

#include <dlfcn.h>

#include <initializer_list>
#include <string>

#include "render/render_error.h"

namespace verisim::render {

/// Opens the first of these libraries that exists. It stays open until the process ends: GL
/// drivers leave threads and exit handlers behind that need their code.
inline void* open_library(std::initializer_list<const char*> names) {
  std::string error;
  for (const char* name : names) {
    if (void* library = dlopen(name, RTLD_NOW | RTLD_LOCAL)) return library;
    error = dlerror();
  }
  throw RenderError(error);
}

template <typename Function>
Function library_function(void* library, const char* name) {
  void* address = dlsym(library, name);
  if (address == nullptr) throw RenderError(std::string("the library has no ") + name);
  return reinterpret_cast<Function>(address);
}

}  // namespace verisim::render
