// SPDX-License-Identifier: MIT
// Off-screen contexts from EGL, without a display server: by device or surfaceless.
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <cstdio>
#include <cstring>

#include "render/context.h"
#include "render/shared_library.h"

namespace verisim::render {
namespace {

struct Egl {
  PFNEGLGETPROCADDRESSPROC get_proc_address;
  PFNEGLGETERRORPROC get_error;
  PFNEGLQUERYSTRINGPROC query_string;
  PFNEGLINITIALIZEPROC initialize;
  PFNEGLTERMINATEPROC terminate;
  PFNEGLBINDAPIPROC bind_api;
  PFNEGLCREATECONTEXTPROC create_context;
  PFNEGLDESTROYCONTEXTPROC destroy_context;
  PFNEGLMAKECURRENTPROC make_current;
};

Egl load_egl() {
  void* library = open_library({"libEGL.so.1"});
  Egl egl;
  egl.get_proc_address = library_function<PFNEGLGETPROCADDRESSPROC>(library, "eglGetProcAddress");
  egl.get_error = library_function<PFNEGLGETERRORPROC>(library, "eglGetError");
  egl.query_string = library_function<PFNEGLQUERYSTRINGPROC>(library, "eglQueryString");
  egl.initialize = library_function<PFNEGLINITIALIZEPROC>(library, "eglInitialize");
  egl.terminate = library_function<PFNEGLTERMINATEPROC>(library, "eglTerminate");
  egl.bind_api = library_function<PFNEGLBINDAPIPROC>(library, "eglBindAPI");
  egl.create_context = library_function<PFNEGLCREATECONTEXTPROC>(library, "eglCreateContext");
  egl.destroy_context = library_function<PFNEGLDESTROYCONTEXTPROC>(library, "eglDestroyContext");
  egl.make_current = library_function<PFNEGLMAKECURRENTPROC>(library, "eglMakeCurrent");
  return egl;
}

[[noreturn]] void fail(const Egl& egl, const char* action) {
  char code[16];
  std::snprintf(code, sizeof code, "0x%04x", static_cast<unsigned>(egl.get_error()));
  throw RenderError(std::string(action) + " failed with EGL error " + code);
}

template <typename Function>
Function extension_function(const Egl& egl, const char* name) {
  auto function = reinterpret_cast<Function>(egl.get_proc_address(name));
  if (function == nullptr) throw RenderError(std::string("this EGL has no ") + name);
  return function;
}

class EglContext final : public Context {
 public:
  EglContext(const Egl& egl, EGLDisplay display, std::string name)
      : egl_(egl), display_(display), name_(std::move(name)) {
    if (display_ == EGL_NO_DISPLAY) fail(egl_, "eglGetPlatformDisplayEXT");
    if (!egl_.initialize(display_, nullptr, nullptr)) fail(egl_, "eglInitialize");
    if (!egl_.bind_api(EGL_OPENGL_API)) fail_after_initialize("eglBindAPI");
    const std::array<EGLint, 7> attributes{EGL_CONTEXT_MAJOR_VERSION,
                                           3,
                                           EGL_CONTEXT_MINOR_VERSION,
                                           3,
                                           EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                           EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                           EGL_NONE};
    context_ = egl_.create_context(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
    if (context_ == EGL_NO_CONTEXT) fail_after_initialize("eglCreateContext");
    if (!egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
      egl_.destroy_context(display_, context_);
      fail_after_initialize("eglMakeCurrent");
    }
  }

  ~EglContext() override {
    egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    egl_.destroy_context(display_, context_);
    egl_.terminate(display_);
  }

  GetProcAddress get_proc_address() const override {
    return [get = egl_.get_proc_address](const char* function) {
      return reinterpret_cast<void*>(get(function));
    };
  }
  std::string name() const override { return name_; }

 private:
  [[noreturn]] void fail_after_initialize(const char* action) {
    char code[16];
    std::snprintf(code, sizeof code, "0x%04x", static_cast<unsigned>(egl_.get_error()));
    egl_.terminate(display_);
    throw RenderError(std::string(action) + " failed with EGL error " + code);
  }

  Egl egl_;
  EGLDisplay display_;
  EGLContext context_ = EGL_NO_CONTEXT;
  std::string name_;
};

}  // namespace

std::unique_ptr<Context> make_egl_device_context() {
  const Egl egl = load_egl();
  const auto query_devices =
      extension_function<PFNEGLQUERYDEVICESEXTPROC>(egl, "eglQueryDevicesEXT");
  const auto query_device_string =
      extension_function<PFNEGLQUERYDEVICESTRINGEXTPROC>(egl, "eglQueryDeviceStringEXT");
  const auto get_display =
      extension_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>(egl, "eglGetPlatformDisplayEXT");
  std::array<EGLDeviceEXT, 16> devices{};
  EGLint num_devices = 0;
  if (!query_devices(devices.size(), devices.data(), &num_devices)) {
    fail(egl, "eglQueryDevicesEXT");
  }
  // Mesa's software device gives the same pixels on every machine; a GPU would not.
  for (EGLint i = 0; i < num_devices; ++i) {
    const char* extensions = query_device_string(devices[i], EGL_EXTENSIONS);
    if (extensions == nullptr || !std::strstr(extensions, "EGL_MESA_device_software")) continue;
    return std::make_unique<EglContext>(
        egl, get_display(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr), "egl-device");
  }
  throw RenderError("none of the " + std::to_string(num_devices) +
                    " EGL devices is Mesa's software device");
}

std::unique_ptr<Context> make_egl_surfaceless_context() {
  const Egl egl = load_egl();
  const auto get_display =
      extension_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>(egl, "eglGetPlatformDisplayEXT");
  return std::make_unique<EglContext>(
      egl, get_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr), "egl-surfaceless");
}

}  // namespace verisim::render
