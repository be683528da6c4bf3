// SPDX-License-Identifier: MIT
// How large a mesh is along its own axes.
#pragma once

#include <Eigen/Geometry>

#include "shape/mesh.h"

namespace verisim::shape {

/// The smallest box along the mesh's axes that holds all vertices, m. Empty for an empty mesh.
Eigen::AlignedBox3d bounding_box(const Mesh& mesh);

/// The shortest edge of the bounding box, m: the size that penetration is compared with.
double smallest_extent(const Mesh& mesh);

}  // namespace verisim::shape
