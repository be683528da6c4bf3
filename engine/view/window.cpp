// SPDX-License-Identifier: MIT
#include "view/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <stb_image_write.h>
#include <unistd.h>

#include <fstream>
#include <vector>

#include "view/view_error.h"

namespace verisim::view {
namespace {

constexpr int kSmallestWidth = 820, kSmallestHeight = 560;  // units; the panel still fits

std::string last_glfw_error() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text == nullptr ? "no cause given" : text;
}

void append_bytes(void* stream, void* data, int size) {
  static_cast<std::ofstream*>(stream)->write(static_cast<const char*>(data), size);
}

void note_key(GLFWwindow* window, int key, int /*scancode*/, int action, int /*modifiers*/) {
  if (action == GLFW_RELEASE) return;
  static_cast<std::vector<KeyPress>*>(glfwGetWindowUserPointer(window))
      ->push_back({key, action == GLFW_REPEAT});
}

}  // namespace

Window::Window(const std::string& title, int width, int height) {
  if (glfwInit() != GLFW_TRUE) {
    throw ViewError(
        "the viewer needs a display (X11 or Wayland) and found none: " + last_glfw_error() +
        "\nhint: `verisim render` needs no display; on a machine without a screen "
        "`xvfb-run -a verisim view ...` gives the viewer one");
  }
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (window_ == nullptr) {
    const std::string cause = last_glfw_error();
    glfwTerminate();
    throw ViewError("the display gives no window with OpenGL 3.3: " + cause +
                    "\nhint: update the graphics driver; `verisim render` draws in software");
  }
  glfwSetWindowSizeLimits(window_, kSmallestWidth, kSmallestHeight, GLFW_DONT_CARE, GLFW_DONT_CARE);
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  gl_ = render::load_gl(get_proc_address());
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // leave no file in the working directory
  glfwSetWindowUserPointer(window_, &keys_);
  glfwSetKeyCallback(window_, note_key);  // Dear ImGui calls it before its own
  ImGui_ImplGlfw_InitForOpenGL(window_, true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Window::~Window() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

bool Window::start_frame(double patience) {
  keys_.clear();
  if (patience > 0) {
    glfwWaitEventsTimeout(patience);
  } else {
    glfwPollEvents();
  }
  if (glfwWindowShouldClose(window_) == GLFW_TRUE) return false;
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  return true;
}

void Window::clear() const {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl_.Clear(GL_COLOR_BUFFER_BIT);
}

void Window::end_frame(const std::filesystem::path& screenshot) {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl_.Viewport(0, 0, size().x(), size().y());
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  if (!screenshot.empty()) write_png(screenshot);
  glfwSwapBuffers(window_);
}

render::GetProcAddress Window::get_proc_address() const {
  return [](const char* name) { return reinterpret_cast<void*>(glfwGetProcAddress(name)); };
}

Eigen::Vector2i Window::size() const {
  Eigen::Vector2i size(0, 0);
  glfwGetFramebufferSize(window_, &size.x(), &size.y());
  return size;
}

double Window::pixels_per_unit() const {
  int width = 0, height = 0;
  glfwGetWindowSize(window_, &width, &height);
  return width > 0 ? static_cast<double>(size().x()) / width : 1;
}

void Window::write_png(const std::filesystem::path& file) const {
  const int width = size().x(), height = size().y();
  std::vector<unsigned char> rgb(3 * static_cast<std::size_t>(width) * height);
  gl_.ReadBuffer(GL_BACK);
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl_.ReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, rgb.data());
  const std::filesystem::path temporary =
      file.parent_path() / ("." + file.filename().string() + "." + std::to_string(getpid()));
  std::ofstream stream(temporary, std::ios::binary);
  // Rows come from the bottom up: start at the last and step back.
  stbi_write_png_to_func(append_bytes, &stream, width, height, 3,
                         rgb.data() + 3 * static_cast<std::size_t>(width) * (height - 1),
                         -3 * width);
  stream.close();
  std::error_code error;
  if (stream) std::filesystem::rename(temporary, file, error);
  if (!stream || error) {
    std::filesystem::remove(temporary, error);
    throw ViewError(file.string() + " cannot be written\nhint: does its folder exist?");
  }
}

}  // namespace verisim::view
