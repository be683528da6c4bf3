// SPDX-License-Identifier: MIT
// Every backend starts and gives the same pixels; a missing backend is a failure, never a skip.
#include "render/context.h"

#include <doctest/doctest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "render/render_error.h"
#include "small_scene.h"

namespace verisim::render {
namespace {

/// Threads of this process that Mesa's software renderer made.
int count_raster_threads() {
  int count = 0;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::string name;
    std::getline(std::ifstream(task.path() / "comm"), name);
    count += name.starts_with("llvmpipe-");
  }
  return count;
}

/// What this program prints when it runs one of its own test cases in another environment.
std::string output_of(const std::string& environment, const std::string& test_case) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string command =
      environment + " '" + self + "' --no-skip --test-case=" + test_case + " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  std::string text;
  for (int c = 0; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  pclose(pipe);
  return text;
}

}  // namespace

TEST_CASE("every_backend_gives_the_same_pixels") {
  const Still still = small_still();
  const Pixels reference = picture_of(*make_context(ContextKind::kEglDevice, 0), still);
  for (const ContextKind kind : {ContextKind::kEglSurfaceless, ContextKind::kOsmesa}) {
    const auto context = make_context(kind, 0);
    CAPTURE(context->name());
    CHECK(picture_of(*context, still) == reference);
  }
}

TEST_CASE("pixels_do_not_depend_on_raster_threads") {
  const Still still = small_still();
  const Pixels reference = picture_of(*make_context(ContextKind::kEglDevice, 0), still);
  for (const int threads : {1, 2}) {
    CAPTURE(threads);
    const auto context = make_context(ContextKind::kEglDevice, threads);
    CHECK(count_raster_threads() == threads);
    CHECK(picture_of(*context, still) == reference);
  }
}

TEST_CASE("auto_prefers_the_software_device") {
  CHECK(make_context(ContextKind::kAuto, 0)->name() == "egl-device");
  CHECK(make_context(ContextKind::kEgl, 0)->name() == "egl-device");
}

TEST_CASE("helper_that_starts_egl" * doctest::skip()) {  // for the test below, in another process
  try {
    make_context(ContextKind::kEgl, 0);
    std::puts("started");
  } catch (const RenderError& error) {
    std::puts(error.what());
  }
}

TEST_CASE("a_failure_lists_each_backend_its_error_and_its_package") {
  CHECK(output_of("", "helper_that_starts_egl").find("started") != std::string::npos);
  // The vendor-neutral libEGL finds no driver when this list is empty.
  const std::string text =
      output_of("__EGL_VENDOR_LIBRARY_FILENAMES=/nowhere", "helper_that_starts_egl");
  CAPTURE(text);
  for (const char* expected : {"egl-device: ", "egl-surfaceless: ", "EGL error 0x",
                               "(Debian packages: libegl1 libegl-mesa0", "hint: install"}) {
    CAPTURE(expected);
    CHECK(text.find(expected) != std::string::npos);
  }
  CHECK(text.find("osmesa:") == std::string::npos);  // only what was asked for is tried
}

TEST_CASE("context_kinds_have_names") {
  CHECK(context_kind("auto") == ContextKind::kAuto);
  CHECK(context_kind("osmesa") == ContextKind::kOsmesa);
  CHECK(context_kind("egl-surfaceless") == ContextKind::kEglSurfaceless);
  CHECK(!context_kind("vulkan"));
}

}  // namespace verisim::render
