// SPDX-License-Identifier: MIT
#include "scene/drag_patches.h"

#include <Eigen/Geometry>

#include "shape/extents.h"

namespace verisim::scene {
namespace {

using Eigen::Vector3d;

// Longest edge of a patch, of the longest extent: a turning body's speed differs little over it.
constexpr double kLongestEdge = 0.25;

void add_patches(const Vector3d& a, const Vector3d& b, const Vector3d& c, double longest,
                 std::vector<dem::DragPatch>& patches) {
  const double ab = (b - a).norm(), bc = (c - b).norm(), ca = (a - c).norm();
  // Halved across its longest edge.
  if (ab > longest && ab >= bc && ab >= ca) {
    const Vector3d middle = 0.5 * (a + b);
    add_patches(a, middle, c, longest, patches);
    add_patches(middle, b, c, longest, patches);
    return;
  }
  if (bc > longest && bc >= ca) return add_patches(b, c, a, longest, patches);
  if (ca > longest) return add_patches(c, a, b, longest, patches);
  const Vector3d across = (b - a).cross(c - a);
  const double size = across.norm();
  if (size > 0) patches.push_back({(a + b + c) / 3, across / size, 0.5 * size});
}

}  // namespace

std::vector<dem::DragPatch> make_drag_patches(const shape::Mesh& mesh_from_com) {
  const double longest =
      kLongestEdge * shape::bounding_box(mesh_from_com).sizes().maxCoeff() * (1 + 1e-9);
  std::vector<dem::DragPatch> patches;
  for (const auto& [i, j, k] : mesh_from_com.triangles) {
    const auto vertex = [&](int n) -> const Vector3d& {
      return mesh_from_com.vertices[static_cast<std::size_t>(n)];
    };
    add_patches(vertex(i), vertex(j), vertex(k), longest, patches);
  }
  return patches;
}

}  // namespace verisim::scene
