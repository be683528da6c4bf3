// SPDX-License-Identifier: MIT
// Reads a triangle mesh from an OBJ, PLY, STL, glTF or GLB file.
#pragma once

#include <filesystem>

#include "shape/mesh.h"
#include "shape/mesh_error.h"

namespace verisim::shape {

/// All triangles of the file as one mesh: node transforms applied, polygons triangulated, and
/// vertices with bitwise equal positions joined, so that a closed surface is closed by its indices
/// (STL stores no indices; other formats split vertices at seams).
/// Axes and lengths are the file's own; coordinates carry the 32-bit precision of the reader.
/// Vertices that no triangle uses are left out.
/// Throws MeshError for a missing or unreadable file, another format, a coordinate that is not a
/// finite 32-bit number, and a file without triangles. Closedness is `check_mesh`'s matter.
Mesh load_mesh(const std::filesystem::path& file);

}  // namespace verisim::shape
