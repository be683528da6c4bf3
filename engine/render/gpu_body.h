// SPDX-License-Identifier: MIT
// One body's triangles or spheres on the graphics side, and how to draw them.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "render/gl_objects.h"
#include "render/vertex_mesh.h"
#include "render/visual_scene.h"

namespace verisim::render {

/// Vertices and indices in GL buffers.
struct GpuMesh {
  GlBuffer vertices, indices;
  int num_indices = 0;
};

GpuMesh upload_mesh(const Gl& gl, const VertexMesh& mesh);

/// Unit spheres from coarse to fine; the caller draws the coarsest that looks round.
class SphereLevels {
 public:
  explicit SphereLevels(const Gl& gl);
  /// Level for a sphere of this radius on the screen: its outline errs by under 0.1 pixel.
  const GpuMesh& level(float radius_px) const;

 private:
  std::vector<GpuMesh> levels_;
};

class GpuBody {
 public:
  GpuBody(const Gl& gl, const VisualBody& body);

  /// Draws with the program in use. pixels_per_metre: scale where the body is.
  void draw(const Gl& gl, const SphereLevels& spheres, float pixels_per_metre) const;

  glm::vec3 low, high;                     // m, bounding box about the centre of mass, body axes
  float bounding_radius = 0;               // m, about the centre of mass
  glm::vec3 tone_dark, tone_light;         // linear
  glm::vec3 cell_low, cell_high;           // extent of the body in cells
  glm::vec3 pattern_scale, pattern_shift;  // body position to cells

 private:
  void measure(const VisualBody& body, const VertexMesh& mesh);
  void mix_paint(const VisualBody& body);

  GlVertexArray mesh_array_, sphere_array_;
  GpuMesh mesh_;
  GlBuffer sphere_instances_;
  int num_spheres_ = 0;
  float largest_sphere_ = 0;  // m
};

}  // namespace verisim::render
