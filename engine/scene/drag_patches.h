// SPDX-License-Identifier: MIT
// The surface of a body as moving air sees it.
#pragma once

#include <vector>

#include "dem/definition.h"
#include "shape/mesh.h"

namespace verisim::scene {

/// Pieces of a mesh given in the body frame: its triangles, cut until no edge is longer than a
/// quarter of the longest extent. Their areas add up to that of the mesh.
std::vector<dem::DragPatch> make_drag_patches(const shape::Mesh& mesh_from_com);

}  // namespace verisim::scene
