// SPDX-License-Identifier: MIT
// The window on the screen, its OpenGL 3.3 context and Dear ImGui in it.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "render/gl_functions.h"

struct GLFWwindow;

namespace verisim::view {

/// A key that went down, or that repeats while held.
struct KeyPress {
  int key;  // GLFW_KEY_...
  bool is_repeat;
};

class Window {
 public:
  /// Opens a window whose context is current. Throws ViewError where there is no display or no
  /// OpenGL 3.3.
  Window(const std::string& title, int width, int height);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Handles what happened since, waiting up to `patience` seconds if nothing did, and starts the
  /// next frame of Dear ImGui. False when the window is to close.
  bool start_frame(double patience);
  /// Clears the window before the scene is copied into it.
  void clear() const;
  /// Draws the panels over the scene and, if `screenshot` is a name, writes the whole window as
  /// PNG: by rename. Then shows the frame. Throws ViewError when the file cannot be written.
  void end_frame(const std::filesystem::path& screenshot);

  /// Keys pressed since the frame before. Dear ImGui 1.86 misses a key that goes down and up
  /// within one frame, which a slow frame makes likely.
  const std::vector<KeyPress>& keys() const { return keys_; }

  render::GetProcAddress get_proc_address() const;
  /// Size in pixels of the framebuffer, and how many of them one unit of the mouse's is.
  Eigen::Vector2i size() const;
  double pixels_per_unit() const;

 private:
  void write_png(const std::filesystem::path& file) const;

  GLFWwindow* window_ = nullptr;
  std::vector<KeyPress> keys_;
  render::Gl gl_;
};

}  // namespace verisim::view
