// SPDX-License-Identifier: MIT
// Off-screen OpenGL contexts behind one small interface: EGL (device, surfaceless) and OSMesa.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "render/gl_functions.h"

namespace verisim::render {

/// A context that is current on the thread that made it, until it is destroyed there.
class Context {
 public:
  virtual ~Context() = default;
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  virtual GetProcAddress get_proc_address() const = 0;
  virtual std::string name() const = 0;  // "egl-device", "egl-surfaceless", "osmesa"

 protected:
  Context() = default;
};

/// kAuto tries EGL device, EGL surfaceless, OSMesa; kEgl the first two.
enum class ContextKind { kAuto, kEgl, kEglDevice, kEglSurfaceless, kOsmesa };

/// The kind called "auto", "egl", "egl-device", "egl-surfaceless" or "osmesa"; none if unknown.
std::optional<ContextKind> context_kind(std::string_view name);

/// Makes an OpenGL 3.3 core context current on this thread.
/// raster_threads: threads that Mesa rasterises with, 0 = the calling thread itself. It sets
/// LP_NUM_THREADS of this process, which Mesa reads when the context is made; other drivers
/// ignore it. Pixels do not depend on it.
/// Throws RenderError that lists each backend tried, its error and the package that supplies it.
std::unique_ptr<Context> make_context(ContextKind kind, int raster_threads);

// One function per backend; each throws RenderError with the cause alone.
std::unique_ptr<Context> make_egl_device_context();
std::unique_ptr<Context> make_egl_surfaceless_context();
std::unique_ptr<Context> make_osmesa_context();

}  // namespace verisim::render
