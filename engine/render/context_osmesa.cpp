// SPDX-License-Identifier: MIT
// Off-screen context from OSMesa: Mesa's software renderer as a plain library, without EGL.
#include <array>
#include <vector>

#include "render/context.h"
#include "render/shared_library.h"

namespace verisim::render {
namespace {

// The part of osmesa.h that is used; that header would pull in the old gl.h.
using OsmesaContext = void*;
constexpr int kOsmesaFormat = 0x22, kOsmesaDepthBits = 0x30, kOsmesaProfile = 0x33,
              kOsmesaCoreProfile = 0x34, kOsmesaMajorVersion = 0x36, kOsmesaMinorVersion = 0x37;
using CreateContextAttribs = OsmesaContext (*)(const int* attributes, OsmesaContext share);
using DestroyContext = void (*)(OsmesaContext);
using MakeCurrent = unsigned char (*)(OsmesaContext, void* buffer, GLenum type, GLsizei width,
                                      GLsizei height);
using OsmesaGetProcAddress = void (*(*)(const char*))();

class OsmesaContextOwner final : public Context {
 public:
  OsmesaContextOwner() : buffer_(kSize * kSize * 4) {
    void* library = open_library({"libOSMesa.so.8", "libOSMesa.so.6"});
    const auto create =
        library_function<CreateContextAttribs>(library, "OSMesaCreateContextAttribs");
    destroy_ = library_function<DestroyContext>(library, "OSMesaDestroyContext");
    make_current_ = library_function<MakeCurrent>(library, "OSMesaMakeCurrent");
    get_ = library_function<OsmesaGetProcAddress>(library, "OSMesaGetProcAddress");
    const std::array<int, 11> attributes{kOsmesaFormat,
                                         GL_RGBA,
                                         kOsmesaDepthBits,
                                         0,
                                         kOsmesaProfile,
                                         kOsmesaCoreProfile,
                                         kOsmesaMajorVersion,
                                         3,
                                         kOsmesaMinorVersion,
                                         3,
                                         0};
    context_ = create(attributes.data(), nullptr);
    if (context_ == nullptr) throw RenderError("OSMesaCreateContextAttribs refused OpenGL 3.3");
    if (!make_current_(context_, buffer_.data(), GL_UNSIGNED_BYTE, kSize, kSize)) {
      destroy_(context_);
      throw RenderError("OSMesaMakeCurrent failed");
    }
  }

  ~OsmesaContextOwner() override {
    make_current_(nullptr, nullptr, 0, 0, 0);
    destroy_(context_);
  }

  GetProcAddress get_proc_address() const override {
    return [get = get_](const char* function) { return reinterpret_cast<void*>(get(function)); };
  }
  std::string name() const override { return "osmesa"; }

 private:
  // OSMesa insists on a buffer of its own; the renderer draws into another.
  static constexpr int kSize = 16;
  std::vector<unsigned char> buffer_;
  OsmesaContext context_ = nullptr;
  DestroyContext destroy_ = nullptr;
  MakeCurrent make_current_ = nullptr;
  OsmesaGetProcAddress get_ = nullptr;
};

}  // namespace

std::unique_ptr<Context> make_osmesa_context() { return std::make_unique<OsmesaContextOwner>(); }

}  // namespace verisim::render
