// SPDX-License-Identifier: MIT
// The order in which backends are tried, and what to say when none works.
#include "render/context.h"

#include <array>
#include <cstdlib>

#include "render/render_error.h"

namespace verisim::render {
namespace {

struct Backend {
  const char* name;
  ContextKind kind;
  bool is_egl;
  std::unique_ptr<Context> (*make)();
  const char* packages;  // Debian
};

constexpr std::array<Backend, 3> kBackends{{
    {"egl-device", ContextKind::kEglDevice, true, make_egl_device_context,
     "libegl1 libegl-mesa0 libgl1-mesa-dri"},
    {"egl-surfaceless", ContextKind::kEglSurfaceless, true, make_egl_surfaceless_context,
     "libegl1 libegl-mesa0 libgl1-mesa-dri"},
    {"osmesa", ContextKind::kOsmesa, false, make_osmesa_context, "libosmesa6"},
}};

bool is_wanted(const Backend& backend, ContextKind kind) {
  return kind == ContextKind::kAuto || kind == backend.kind ||
         (kind == ContextKind::kEgl && backend.is_egl);
}

}  // namespace

std::optional<ContextKind> context_kind(std::string_view name) {
  if (name == "auto") return ContextKind::kAuto;
  if (name == "egl") return ContextKind::kEgl;
  for (const Backend& backend : kBackends) {
    if (name == backend.name) return backend.kind;
  }
  return std::nullopt;
}

std::unique_ptr<Context> make_context(ContextKind kind, int raster_threads) {
  setenv("LP_NUM_THREADS", std::to_string(raster_threads).c_str(), 1);
  std::string tried;
  for (const Backend& backend : kBackends) {
    if (!is_wanted(backend, kind)) continue;
    try {
      return backend.make();
    } catch (const RenderError& error) {
      tried += std::string("\n  ") + backend.name + ": " + error.what() +
               " (Debian packages: " + backend.packages + ")";
    }
  }
  throw RenderError("no off-screen OpenGL 3.3 could be started; tried:" + tried +
                    "\nhint: install the packages of one backend, for example: apt-get install " +
                    kBackends.front().packages);
}

}  // namespace verisim::render
