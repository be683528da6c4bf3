// SPDX-License-Identifier: MIT
// The passes of one picture, in order.
#include "render/renderer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/colour_space.h"
#include "render/glm_eigen.h"
#include "render/render_error.h"
#include "render/shaders.h"

namespace verisim::render {
namespace {

// Light, linear. Sun plus sky on a face turned to the sun is 1.05; with paint of at most 0.8 that
// stays below white.
const glm::vec3 kSunLight(0.80F, 0.77F, 0.72F);
const glm::vec3 kSkyLight(0.27F, 0.29F, 0.33F);
const glm::vec3 kBounceLight(0.15F, 0.14F, 0.13F);
// Neutral greys: a trace of colour would step between the few levels that 8-bit video has for it.
constexpr Colour kTileLight{0.65F, 0.65F, 0.65F};
constexpr Colour kTileDark{0.55F, 0.55F, 0.55F};
constexpr Colour kHorizon{0.76F, 0.76F, 0.76F};
constexpr Colour kZenith{0.50F, 0.58F, 0.68F};
constexpr float kFadeDistance = 5;  // of the distance from the camera to what it looks at

const glm::vec2 kShadowTap(0.6F, 0.2F);  // texels from the middle, to either side
constexpr float kShadowOffset = 2.4F;    // texels along the normal; less shows acne, more lifts
constexpr float kShadowMargin = 4;       // texels that the edge of a shadow is blurred by, at most
constexpr float kSlopeOffset = 1.1F;     // depth slopes

Gl checked(const GetProcAddress& get, int width, int height) {
  if (width < 2 || height < 2 || width > 16384 || height > 16384) {
    throw RenderError("picture size is " + std::to_string(width) + "x" + std::to_string(height) +
                      "; 2 to 16384 pixels each way are allowed");
  }
  return load_gl(get);
}

}  // namespace

Renderer::Renderer(const GetProcAddress& get_proc_address, VisualScene scene, int width, int height)
    : gl_(checked(get_proc_address, width, height)),
      scene_(std::move(scene)),
      view_(make_view(scene_.camera, width, height)),
      shadow_tiles_(width, height),
      framebuffer_(gl_, width, height),
      shadow_map_(gl_),
      spheres_(gl_),
      caster_program_(gl_, caster_vertex_shader(), caster_fragment_shader()),
      body_program_(gl_, body_vertex_shader(), body_fragment_shader()),
      background_program_(gl_, background_vertex_shader(), background_fragment_shader()),
      shadow_area_program_(gl_, shadow_area_vertex_shader(), shadow_area_fragment_shader()),
      empty_array_(gl_),
      shadow_area_array_(gl_),
      shadow_area_buffer_(gl_) {
  for (const VisualBody& body : scene_.bodies) bodies_.emplace_back(gl_, body);
  gl_.BindVertexArray(shadow_area_array_.id());
  gl_.BindBuffer(GL_ARRAY_BUFFER, shadow_area_buffer_.id());
  gl_.VertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(glm::vec2), nullptr);
  gl_.EnableVertexAttribArray(0);
}

void Renderer::set_camera(const Camera& camera) {
  view_ = make_view(camera, width(), height());
  scene_.camera = camera;
  background_is_current_ = false;
}

void Renderer::resize(int width, int height) {
  framebuffer_ = Framebuffer(gl_, width, height);
  shadow_tiles_ = TileMask(width, height);
  set_camera(scene_.camera);
}

void Renderer::fit_light(std::span<const dem::Pose> poses) {
  std::vector<BoundingSphere> spheres;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    spheres.push_back({to_glm(poses[i].position), bodies_[i % bodies_.size()].bounding_radius});
  }
  light_ = render::fit_light(scene_, view_, spheres);
  shadow_map_.resize(light_.width, light_.height);
}

void Renderer::draw(std::span<const dem::Pose> poses) {
  gl_.Enable(GL_DEPTH_TEST);
  gl_.Enable(GL_CULL_FACE);
  gl_.Disable(GL_SCISSOR_TEST);  // a window's panels may have left these on
  gl_.Disable(GL_BLEND);
  draw_casters(poses);
  if (!background_is_current_) draw_background();
  // Pixels outside of what was drawn last time still show the background.
  const PixelRect restored = drawn_;
  find_changing_pixels(poses);
  framebuffer_.start_from_background(restored);
  draw_bodies(poses);
  if (ground_is_seen()) draw_shadow_areas();
  framebuffer_.resolve(unite(restored, drawn_));
}

void Renderer::find_changing_pixels(std::span<const dem::Pose> poses) {
  drawn_ = {};
  shadow_tiles_.clear();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const auto corners = world_corners({body_to_world(poses[b]), bodies_[b].low, bodies_[b].high});
    const auto body_pixels = to_pixels(view_, corners);
    drawn_ = unite(drawn_, body_pixels ? touched_pixels(view_, *body_pixels) : framebuffer_.all());
    if (!ground_is_seen()) continue;
    const auto shadow_pixels = to_pixels(
        view_, shadow_outline(scene_.ground, scene_.sun, corners, kShadowMargin * light_.texel));
    if (shadow_pixels) {
      shadow_tiles_.mark(*shadow_pixels);
      drawn_ = unite(drawn_, touched_pixels(view_, *shadow_pixels));
    } else {
      shadow_tiles_.mark_all();
      drawn_ = framebuffer_.all();
    }
  }
}

void Renderer::sort_by_distance(std::span<const dem::Pose> poses) {
  const auto distance = [&](std::size_t b) {
    return glm::length(to_glm(poses[b].position) - view_.eye);
  };
  near_to_far_.resize(bodies_.size());
  std::iota(near_to_far_.begin(), near_to_far_.end(), 0);
  std::stable_sort(near_to_far_.begin(), near_to_far_.end(),
                   [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
}

/// The ground's depth in clip space as a linear function of x, y, 1: the plane in clip space.
glm::vec3 Renderer::ground_depth() const {
  const glm::vec4 plane(to_glm(scene_.ground.normal), -static_cast<float>(scene_.ground.offset));
  const glm::vec4 p = plane * glm::inverse(view_.world_to_clip);
  return glm::vec3(p.x, p.y, p.w) / -p.z;
}

void Renderer::read_pixels(std::span<std::uint8_t> rgba) const { framebuffer_.read(rgba); }

void Renderer::copy_to(GLuint target) const { framebuffer_.copy_to(target); }

std::string Renderer::driver() const {
  const auto text = [this](GLenum name) {
    return std::string(reinterpret_cast<const char*>(gl_.GetString(name)));
  };
  return text(GL_RENDERER) + ", OpenGL " + text(GL_VERSION);
}

bool Renderer::ground_is_seen() const {
  const Ground& ground = scene_.ground;
  return ground.present && ground.normal.dot(scene_.camera.position) > ground.offset;
}

float Renderer::pixels_per_metre(const dem::Pose& pose) const {
  const float distance = glm::length(to_glm(pose.position) - view_.eye);
  return view_.pixels_per_radian / std::max(distance, 1e-3F);
}

void Renderer::draw_casters(std::span<const dem::Pose> poses) {
  shadow_map_.start();
  gl_.Enable(GL_POLYGON_OFFSET_FILL);
  gl_.PolygonOffset(kSlopeOffset, 1);
  caster_program_.use();
  caster_program_.set("world_to_sun", light_.world_to_sun);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    caster_program_.set("body_to_world", body_to_world(poses[b]));
    bodies_[b].draw(gl_, spheres_, pixels_per_metre(poses[b]));
  }
  gl_.Disable(GL_POLYGON_OFFSET_FILL);
}

void Renderer::set_ground_uniforms(const Program& program) const {
  const Ground& ground = scene_.ground;
  const auto [first, second] = ground_axes(ground);
  const glm::vec3 normal = to_glm(ground.normal);
  const glm::mat3 world_to_ground = glm::transpose(glm::mat3(first, second, normal));
  glm::vec3 eye = world_to_ground * view_.eye;
  eye.z -= static_cast<float>(ground.offset);
  program.set("pixel_to_ray", world_to_ground * view_.pixel_to_ray);
  program.set("eye", eye);
  const float tiles_per_metre = 1 / static_cast<float>(ground.checker_size);
  program.set("tiles_per_metre", tiles_per_metre);
  program.set("tile_start", glm::vec2(eye) * tiles_per_metre);
  const auto distance = (scene_.camera.look_at - scene_.camera.position).norm() * kFadeDistance;
  program.set("fade", static_cast<float>(1 / (distance * distance)));
  program.set("tile_dark", to_linear(kTileDark));
  program.set("tile_light", to_linear(kTileLight));
  program.set("horizon", to_linear(kHorizon));
  const float facing = std::max(glm::dot(normal, to_glm(scene_.sun.direction)), 0.0F);
  program.set("ground_light", kSunLight * facing + kSkyLight);
  program.set("ground_sun", kSunLight * facing);
  program.set("ground_ambient", kSkyLight);
}

void Renderer::set_sun_uniforms(const Program& program) const {
  shadow_map_.bind_texture();
  program.set("shadow_map", 0);
  program.set("shadow_tap", kShadowTap / glm::vec2(light_.width, light_.height));
  program.set("world_to_clip", view_.world_to_clip);
}

void Renderer::draw_background() {
  framebuffer_.bind_background();
  background_program_.use();
  set_ground_uniforms(background_program_);
  background_program_.set("has_ground", scene_.ground.present ? 1.0F : 0.0F);
  background_program_.set("zenith", to_linear(kZenith));
  gl_.Disable(GL_DEPTH_TEST);
  gl_.BindVertexArray(empty_array_.id());
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  gl_.Enable(GL_DEPTH_TEST);
  background_is_current_ = true;
  drawn_ = framebuffer_.all();  // all of it must be copied over once
}

void Renderer::draw_bodies(std::span<const dem::Pose> poses) {
  body_program_.use();
  set_sun_uniforms(body_program_);
  body_program_.set("world_to_sun", light_.world_to_sun);
  body_program_.set("shadow_offset", kShadowOffset * light_.texel);
  body_program_.set("to_sun", to_glm(scene_.sun.direction));
  body_program_.set("up", to_glm(scene_.ground.normal));
  body_program_.set("sun_light", kSunLight);
  body_program_.set("ambient_middle", (kSkyLight + kBounceLight) * 0.5F);
  body_program_.set("ambient_slope", (kSkyLight - kBounceLight) * 0.5F);
  glm::vec4 plane(0, 0, 0, -1);
  if (ground_is_seen()) {
    plane = glm::vec4(to_glm(scene_.ground.normal), static_cast<float>(scene_.ground.offset));
  }
  body_program_.set("ground_plane", plane);
  gl_.Enable(GL_CLIP_DISTANCE0);
  sort_by_distance(poses);  // what is hidden is then not shaded
  for (const std::size_t b : near_to_far_) {
    const GpuBody& body = bodies_[b];
    if (!is_in_sight(view_, to_glm(poses[b].position), body.bounding_radius)) continue;
    body_program_.set("body_to_world", body_to_world(poses[b]));
    body_program_.set("tone_dark", body.tone_dark);
    body_program_.set("tone_light", body.tone_light);
    body_program_.set("cell_low", body.cell_low);
    body_program_.set("cell_high", body.cell_high);
    body_program_.set("pattern_scale", body.pattern_scale);
    body_program_.set("pattern_shift", body.pattern_shift);
    body.draw(gl_, spheres_, pixels_per_metre(poses[b]));
  }
  gl_.Disable(GL_CLIP_DISTANCE0);
}

void Renderer::draw_shadow_areas() {
  shadow_area_program_.use();
  set_ground_uniforms(shadow_area_program_);
  set_sun_uniforms(shadow_area_program_);
  const auto [first, second] = ground_axes(scene_.ground);
  const glm::vec3 normal = to_glm(scene_.ground.normal);
  // The ground casts no shadow on itself, so it needs no offset and contact shadows close.
  const glm::vec3 base = normal * static_cast<float>(scene_.ground.offset);
  shadow_area_program_.set(
      "ground_to_sun", light_.world_to_sun * glm::mat4(glm::vec4(first, 0), glm::vec4(second, 0),
                                                       glm::vec4(normal, 0), glm::vec4(base, 1)));
  shadow_area_program_.set("pixel_to_clip", 2.0F / glm::vec2(width(), height()));
  shadow_area_program_.set("ground_depth", ground_depth());
  const std::vector<glm::vec2> corners = shadow_tiles_.triangles();
  gl_.BindVertexArray(shadow_area_array_.id());
  gl_.BindBuffer(GL_ARRAY_BUFFER, shadow_area_buffer_.id());
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof(glm::vec2)),
                 corners.data(), GL_STREAM_DRAW);
  gl_.DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size()));
}

}  // namespace verisim::render
