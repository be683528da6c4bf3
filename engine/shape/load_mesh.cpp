// SPDX-License-Identifier: MIT
// Reads a triangle mesh through assimp and joins vertices that lie at the same place.
#include "shape/load_mesh.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <Eigen/LU>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <unordered_map>
#include <utility>

namespace verisim::shape {
namespace {

// The bits of a position, so that "same place" needs no tolerance.
struct PositionKey {
  std::array<std::uint64_t, 3> bits;
  bool operator==(const PositionKey&) const = default;
};

struct PositionHash {
  std::size_t operator()(const PositionKey& key) const {
    std::uint64_t hash = 0;
    for (std::uint64_t bits : key.bits) {
      hash = (hash ^ bits) * 0x9E3779B97F4A7C15ULL;  // odd constant near 2^64 / golden ratio
      hash ^= hash >> 32;
    }
    return static_cast<std::size_t>(hash);
  }
};

PositionKey position_key(const Eigen::Vector3d& position) {
  PositionKey key{};
  for (int axis = 0; axis < 3; ++axis) {
    key.bits[axis] = std::bit_cast<std::uint64_t>(position[axis]);
  }
  return key;
}

// Gathers triangles of several parts into one mesh with joined vertices.
class MeshBuilder {
 public:
  void add_triangle(const std::array<Eigen::Vector3d, 3>& corners) {
    std::array<int, 3> triangle{};
    for (int corner = 0; corner < 3; ++corner) triangle[corner] = vertex_index(corners[corner]);
    mesh_.triangles.push_back(triangle);
  }

  Mesh take() { return std::move(mesh_); }

 private:
  int vertex_index(const Eigen::Vector3d& position) {
    const auto [entry, is_new] =
        indices_.try_emplace(position_key(position), static_cast<int>(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.push_back(position);
    return entry->second;
  }

  Mesh mesh_;
  std::unordered_map<PositionKey, int, PositionHash> indices_;
};

struct NonFinite {
  long count = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
};

struct Placement {
  Eigen::Matrix3d linear;
  Eigen::Vector3d offset;
};

Placement to_placement(const aiMatrix4x4& matrix) {
  Placement placement;
  placement.linear << matrix.a1, matrix.a2, matrix.a3, matrix.b1, matrix.b2, matrix.b3, matrix.c1,
      matrix.c2, matrix.c3;
  placement.offset << matrix.a4, matrix.b4, matrix.c4;
  return placement;
}

void add_part(const aiMesh& part, const Placement& placement, MeshBuilder& builder,
              NonFinite& nonfinite) {
  // A mirroring node turns the winding round; turn it back so that outside stays outside.
  const bool mirrored = placement.linear.determinant() < 0;
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    if (face.mNumIndices != 3) continue;  // points and lines bound no volume
    std::array<Eigen::Vector3d, 3> corners;
    for (int corner = 0; corner < 3; ++corner) {
      const aiVector3D& p = part.mVertices[face.mIndices[corner]];
      // Adding the offset, which is never -0, also turns -0 into +0, so equal places have equal
      // bits.
      corners[corner] = placement.linear * Eigen::Vector3d(p.x, p.y, p.z) + placement.offset;
      if (!corners[corner].allFinite() && nonfinite.count++ == 0) nonfinite.first = corners[corner];
    }
    if (mirrored) std::swap(corners[1], corners[2]);
    builder.add_triangle(corners);
  }
}

void add_node(const aiScene& scene, const aiNode& node, const Placement& parent,
              MeshBuilder& builder, NonFinite& nonfinite) {
  const Placement own = to_placement(node.mTransformation);
  const Placement placement{parent.linear * own.linear, parent.linear * own.offset + parent.offset};
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    add_part(*scene.mMeshes[node.mMeshes[m]], placement, builder, nonfinite);
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) {
    add_node(scene, *node.mChildren[c], placement, builder, nonfinite);
  }
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& seen,
                         const std::string& hint) {
  throw MeshError(file.string() + ": " + seen + "\nhint: " + hint);
}

// Returns the extension in lower case, with its dot.
std::string require_known_format(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) {
    refuse(file, "no such mesh file", "check the path; it is relative to the file that names it");
  }
  if (!std::filesystem::is_regular_file(file, error)) {
    refuse(file, "is not a file", "name the mesh file itself, not its folder");
  }
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array kKnown = {".obj", ".ply", ".stl", ".gltf", ".glb"};
  if (std::find(kKnown.begin(), kKnown.end(), extension) == kKnown.end()) {
    refuse(file, "mesh format '" + extension + "' is not one of .obj .ply .stl .gltf .glb",
           "export the mesh as OBJ, PLY, STL or glTF");
  }
  return extension;
}

// assimp 5.2 reads a PLY file whose header never ends for ever, so look for its last line first.
// Can go once `unreadable_content_is_refused` ends without it.
void require_whole_ply_header(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string line;
  for (int i = 0; i < 1000 && std::getline(stream, line); ++i) {  // real headers have about 20
    if (line.starts_with("end_header") && !stream.eof()) return;
  }
  refuse(file, "cannot be read as a mesh: its PLY header has no end_header line",
         "the file is cut off or no PLY file; export it again");
}

// assimp's triangulation aborts the program on a face without corners (a cut-off PLY file has some)
// and reads past the end for a corner that does not exist, so refuse both before it runs.
void require_sound_faces(const aiScene& scene, const std::filesystem::path& file) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[m];
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      const unsigned* begin = face.mIndices;
      const unsigned* end = begin + face.mNumIndices;
      const unsigned* bad =
          std::find_if(begin, end, [&part](unsigned index) { return index >= part.mNumVertices; });
      if (face.mNumIndices > 0 && bad == end) continue;
      refuse(file,
             "cannot be read as a mesh: face " + std::to_string(f) + " of part " +
                 std::to_string(m) +
                 (bad == end ? " has no corners"
                             : " names vertex " + std::to_string(*bad) + " of " +
                                   std::to_string(part.mNumVertices)),
             "the file is cut off or damaged; export it again");
    }
  }
}

}  // namespace

Mesh load_mesh(const std::filesystem::path& file) {
  if (require_known_format(file) == ".ply") require_whole_ply_header(file);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (scene != nullptr) {
    require_sound_faces(*scene, file);
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  }
  if (scene == nullptr || scene->mRootNode == nullptr) {
    refuse(file, std::string("cannot be read as a mesh: ") + importer.GetErrorString(),
           "open it in a mesh editor and export it again");
  }

  MeshBuilder builder;
  NonFinite nonfinite;
  const Placement identity{Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()};
  add_node(*scene, *scene->mRootNode, identity, builder, nonfinite);
  if (nonfinite.count > 0) {
    std::ostringstream seen;
    seen << nonfinite.count << " triangle corner(s) not finite, first seen "
         << point_text(nonfinite.first);
    refuse(file, seen.str(), "coordinates must be numbers within +-3e38; look for nan or inf");
  }
  Mesh mesh = builder.take();
  if (mesh.triangles.empty()) {
    refuse(file, "holds no triangles (0 seen)", "export faces, not only points or lines");
  }
  return mesh;
}

}  // namespace verisim::shape
