// SPDX-License-Identifier: MIT
// Uploads and draws bodies.
#include "render/gpu_body.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/colour_space.h"
#include "render/glm_eigen.h"

namespace verisim::render {
namespace {

constexpr std::array<int, 9> kFrequencies{1, 2, 3, 4, 6, 8, 12, 18, 28};
constexpr float kDarkTone = 0.42F;  // linear share of the light tone: plain in sun and in shade

const void* byte_offset(std::size_t bytes) { return reinterpret_cast<const void*>(bytes); }

void point_at_mesh(const Gl& gl, const GpuMesh& mesh) {
  gl.BindBuffer(GL_ARRAY_BUFFER, mesh.vertices.id());
  gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex), byte_offset(0));
  gl.VertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                         byte_offset(offsetof(Vertex, normal)));
  gl.EnableVertexAttribArray(0);
  gl.EnableVertexAttribArray(1);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, mesh.indices.id());
}

template <typename Element>
GlBuffer upload(const Gl& gl, GLenum target, const std::vector<Element>& elements) {
  GlBuffer buffer(gl);
  gl.BindBuffer(target, buffer.id());
  gl.BufferData(target, static_cast<GLsizeiptr>(elements.size() * sizeof(Element)), elements.data(),
                GL_STATIC_DRAW);
  return buffer;
}

}  // namespace

GpuMesh upload_mesh(const Gl& gl, const VertexMesh& mesh) {
  gl.BindVertexArray(0);  // an array that is bound would take the index buffer for its own
  return {upload(gl, GL_ARRAY_BUFFER, mesh.vertices),
          upload(gl, GL_ELEMENT_ARRAY_BUFFER, mesh.indices), static_cast<int>(mesh.indices.size())};
}

SphereLevels::SphereLevels(const Gl& gl) {
  for (const int frequency : kFrequencies) {
    levels_.push_back(upload_mesh(gl, geodesic_sphere(frequency)));
  }
}

const GpuMesh& SphereLevels::level(float radius_px) const {
  constexpr float kSag = 0.2F;  // px between corner and middle of an edge, half on either side
  std::size_t index = 0;
  while (index + 1 < levels_.size()) {
    const float half_angle = std::atan(2.0F) / static_cast<float>(kFrequencies[index]) / 2;
    if (radius_px * (1 - std::cos(half_angle)) < kSag) break;
    ++index;
  }
  return levels_[index];
}

GpuBody::GpuBody(const Gl& gl, const VisualBody& body) {
  const VertexMesh mesh = with_normals(body.mesh, body.mesh_offset);
  measure(body, mesh);
  mix_paint(body);
  if (!mesh.indices.empty()) {
    mesh_ = upload_mesh(gl, mesh);
    mesh_array_ = GlVertexArray(gl);
    gl.BindVertexArray(mesh_array_.id());
    point_at_mesh(gl, mesh_);
  }
  if (!body.spheres.empty()) {
    std::vector<glm::vec4> instances;
    for (const Sphere& sphere : body.spheres) {
      instances.emplace_back(to_glm(sphere.center), static_cast<float>(sphere.radius));
    }
    num_spheres_ = static_cast<int>(instances.size());
    sphere_instances_ = upload(gl, GL_ARRAY_BUFFER, instances);
    sphere_array_ = GlVertexArray(gl);
    gl.BindVertexArray(sphere_array_.id());
    gl.BindBuffer(GL_ARRAY_BUFFER, sphere_instances_.id());
    gl.VertexAttribPointer(2, 4, GL_FLOAT, GL_FALSE, sizeof(glm::vec4), byte_offset(0));
    gl.EnableVertexAttribArray(2);
    gl.VertexAttribDivisor(2, 1);
  }
  gl.BindVertexArray(0);
}

void GpuBody::measure(const VisualBody& body, const VertexMesh& mesh) {
  low = high = glm::vec3(0);
  const auto include = [this](const glm::vec3& center, float radius) {
    low = glm::min(low, center - radius);
    high = glm::max(high, center + radius);
    bounding_radius = std::max(bounding_radius, glm::length(center) + radius);
  };
  for (const Vertex& vertex : mesh.vertices) {
    include({vertex.position.x(), vertex.position.y(), vertex.position.z()}, 0);
  }
  for (const Sphere& sphere : body.spheres) {
    include(to_glm(sphere.center), static_cast<float>(sphere.radius));
    largest_sphere_ = std::max(largest_sphere_, static_cast<float>(sphere.radius));
  }
}

void GpuBody::mix_paint(const VisualBody& body) {
  tone_light = to_linear(body.colour);
  tone_dark = body.pattern.kind == PatternKind::kPlain ? tone_light : kDarkTone * tone_light;
  const glm::vec3 cell = to_glm(body.pattern.cell);
  const glm::vec3 origin = to_glm(body.pattern.origin);
  pattern_scale = 1.0F / cell;
  // Along axes without cells a body stays in the middle of one.
  if (body.pattern.kind == PatternKind::kPlain) pattern_scale = glm::vec3(0);
  if (body.pattern.kind == PatternKind::kBands) pattern_scale = {0, 0, 1 / cell.z};
  for (int axis = 0; axis < 3; ++axis) {
    if (pattern_scale[axis] == 0) {
      pattern_shift[axis] = 0.5F;
      cell_low[axis] = 0;
      cell_high[axis] = 1;
    } else {
      pattern_shift[axis] = -origin[axis] * pattern_scale[axis];
      cell_low[axis] = low[axis] * pattern_scale[axis] + pattern_shift[axis];
      cell_high[axis] = high[axis] * pattern_scale[axis] + pattern_shift[axis];
    }
  }
}

void GpuBody::draw(const Gl& gl, const SphereLevels& spheres, float pixels_per_metre) const {
  if (mesh_.num_indices > 0) {
    gl.BindVertexArray(mesh_array_.id());
    gl.VertexAttrib4f(2, 0, 0, 0, 1);
    gl.DrawElementsInstanced(GL_TRIANGLES, mesh_.num_indices, GL_UNSIGNED_INT, nullptr, 1);
  }
  if (num_spheres_ > 0) {
    const GpuMesh& level = spheres.level(largest_sphere_ * pixels_per_metre);
    gl.BindVertexArray(sphere_array_.id());
    point_at_mesh(gl, level);
    gl.DrawElementsInstanced(GL_TRIANGLES, level.num_indices, GL_UNSIGNED_INT, nullptr,
                             num_spheres_);
  }
}

}  // namespace verisim::render
