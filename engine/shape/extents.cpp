// SPDX-License-Identifier: MIT
// Measures a mesh along its own axes.
#include "shape/extents.h"

namespace verisim::shape {

Eigen::AlignedBox3d bounding_box(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : mesh.vertices) box.extend(vertex);
  return box;
}

double smallest_extent(const Mesh& mesh) { return bounding_box(mesh).sizes().minCoeff(); }

}  // namespace verisim::shape
