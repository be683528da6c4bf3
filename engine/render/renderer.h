// SPDX-License-Identifier: MIT
// Draws one instant of a scene: shadows from the sun, the still background, the bodies.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dem/pose_log.h"
#include "render/framebuffer.h"
#include "render/gpu_body.h"
#include "render/light.h"
#include "render/program.h"
#include "render/shadow_map.h"
#include "render/tile_mask.h"
#include "render/view.h"

namespace verisim::render {

/// Works in whatever OpenGL 3.3 context is current, and on the thread where it is current. The
/// context must outlive the renderer. Equal scene, size, light fit and poses give equal bytes.
class Renderer {
 public:
  /// Throws RenderError on a size below 2 or above 16384 pixels, or when the driver refuses.
  Renderer(const GetProcAddress& get_proc_address, VisualScene scene, int width, int height);

  void set_camera(const Camera& camera);
  void resize(int width, int height);

  /// Fits the shadow map to poses of all bodies, in scene order, at one or many times ([T][B]).
  /// Fit to the whole clip, so that shadows keep still; in an interactive view fit each frame.
  void fit_light(std::span<const dem::Pose> poses);

  /// Draws one pose per body, in scene order.
  void draw(std::span<const dem::Pose> poses);
  /// Reads the picture drawn last: RGBA, rows from the bottom up, 4 * width * height bytes.
  void read_pixels(std::span<std::uint8_t> rgba) const;
  /// Copies the picture drawn last to framebuffer object `target`, 0 = the window.
  void copy_to(GLuint target) const;

  int width() const { return framebuffer_.width(); }
  int height() const { return framebuffer_.height(); }
  const VisualScene& scene() const { return scene_; }
  /// What OpenGL calls itself, for a clip's record: renderer and version.
  std::string driver() const;

 private:
  void draw_background();
  void draw_casters(std::span<const dem::Pose> poses);
  void draw_bodies(std::span<const dem::Pose> poses);
  void draw_shadow_areas();
  void find_changing_pixels(std::span<const dem::Pose> poses);
  void sort_by_distance(std::span<const dem::Pose> poses);
  glm::vec3 ground_depth() const;
  void set_ground_uniforms(const Program& program) const;
  void set_sun_uniforms(const Program& program) const;
  bool ground_is_seen() const;
  float pixels_per_metre(const dem::Pose& pose) const;

  Gl gl_;
  VisualScene scene_;
  View view_;
  Light light_;
  bool background_is_current_ = false;
  PixelRect drawn_;                       // pixels that may differ from the background
  TileMask shadow_tiles_;                 // ground that may be in shadow
  std::vector<std::size_t> near_to_far_;  // bodies
  Framebuffer framebuffer_;
  ShadowMap shadow_map_;
  SphereLevels spheres_;
  std::vector<GpuBody> bodies_;
  Program caster_program_, body_program_, background_program_, shadow_area_program_;
  GlVertexArray empty_array_, shadow_area_array_;
  GlBuffer shadow_area_buffer_;
};

}  // namespace verisim::render
