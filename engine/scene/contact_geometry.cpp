// SPDX-License-Identifier: MIT
// Turns the distance grid and the surface samples of a mesh into what dem reads.
#include "scene/contact_geometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "shape/distance_grid.h"
#include "shape/extents.h"
#include "shape/sharp_features.h"
#include "shape/surface_samples.h"

namespace verisim::scene {
namespace {

constexpr double kSamplesPerExtent = 12;
constexpr double kDefaultMaxNumPoints = 2000;
constexpr int kBlockSize = 32;  // points a loop can pass over at once, and skip at once
constexpr double kReferencePerExtent = 0.25;  // a face of a cube weighs 16, a corner 1

dem::DistanceField distance_field(const shape::Mesh& mesh) {
  shape::DistanceGrid grid = shape::make_distance_grid(mesh, shape::default_grid_spacing(mesh));
  return {grid.origin, grid.spacing, grid.counts, std::move(grid.values)};
}

std::vector<dem::SurfacePoint> weighted_points(const std::vector<shape::SurfaceSample>& samples,
                                               double reference_length) {
  std::vector<dem::SurfacePoint> points;
  points.reserve(samples.size());
  for (const shape::SurfaceSample& sample : samples) {
    if (sample.is_framed) continue;
    const double weight = (sample.is_vertex ? 1.0 : 0.0) + sample.edge_length / reference_length +
                          sample.area / (reference_length * reference_length);
    points.push_back({sample.position, weight});
  }
  return points;
}

dem::SurfaceBlock block_around(const std::vector<dem::SurfacePoint>& points, int first, int count) {
  Eigen::AlignedBox3d box;
  for (int n = first; n < first + count; ++n) box.extend(points[n].position_b);
  dem::SurfaceBlock block{first, count, box.center(), 0, 0};
  for (int n = first; n < first + count; ++n) {
    block.radius = std::max(block.radius, (points[n].position_b - block.centre_b).norm());
  }
  return block;
}

// Halves the points across their longest extent, at a multiple of the block size, until each part
// is a smallest block.
void sort_into_blocks(dem::MeshSurface& surface, int first, int end) {
  std::vector<dem::SurfacePoint>& points = surface.points;
  const int count = end - first;
  const std::size_t block = surface.blocks.size();
  surface.blocks.push_back(block_around(points, first, count));
  surface.blocks[block].next = static_cast<int>(block) + 1;
  if (count <= kBlockSize) return;
  Eigen::AlignedBox3d box;
  for (int n = first; n < end; ++n) box.extend(points[n].position_b);
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  std::stable_sort(
      points.begin() + first, points.begin() + end,
      [axis](const auto& p, const auto& q) { return p.position_b[axis] < q.position_b[axis]; });
  const int num_blocks = (count + kBlockSize - 1) / kBlockSize;
  const int middle = first + num_blocks / 2 * kBlockSize;
  sort_into_blocks(surface, first, middle);
  sort_into_blocks(surface, middle, end);
  surface.blocks[block].next = static_cast<int>(surface.blocks.size());
}

}  // namespace

double default_sample_spacing(const shape::Mesh& mesh) {
  double area = 0;
  for (const shape::FaceShape& face : shape::face_shapes(mesh)) area += face.area;
  double spacing = std::max(shape::smallest_extent(mesh) / kSamplesPerExtent,
                            std::sqrt(area / kDefaultMaxNumPoints));
  // Edges, corners and cells that the surface merely clips add to area / spacing^2.
  constexpr int kMaxNumTrials = 8;
  for (int trial = 0; trial < kMaxNumTrials; ++trial) {
    const double count = static_cast<double>(shape::sample_surface(mesh, spacing).size());
    if (count <= kDefaultMaxNumPoints) break;
    spacing *= 1.02 * std::sqrt(count / kDefaultMaxNumPoints);
  }
  return spacing;
}

dem::MeshSurface make_mesh_surface(const shape::Mesh& mesh_from_com, double sample_spacing) {
  dem::MeshSurface surface;
  surface.field = distance_field(mesh_from_com);
  surface.reference_length = kReferencePerExtent * shape::smallest_extent(mesh_from_com);
  surface.points = weighted_points(shape::sample_surface(mesh_from_com, sample_spacing),
                                   surface.reference_length);
  sort_into_blocks(surface, 0, static_cast<int>(surface.points.size()));
  for (const Eigen::Vector3d& vertex : mesh_from_com.vertices) {
    surface.reach = std::max(surface.reach, vertex.norm());
  }
  return surface;
}

}  // namespace verisim::scene
