// SPDX-License-Identifier: MIT
// Measures angles at the edges and vertices of a mesh.
#include "shape/sharp_features.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <unordered_map>

namespace verisim::shape {
namespace {

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

int corner_opposite(const std::array<int, 3>& triangle, const std::array<int, 2>& edge) {
  for (int vertex : triangle) {
    if (vertex != edge[0] && vertex != edge[1]) return vertex;
  }
  return triangle[0];
}

}  // namespace

std::vector<FaceShape> face_shapes(const Mesh& mesh) {
  std::vector<FaceShape> faces;
  faces.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d twice_area =
        (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    faces.push_back({twice_area.normalized(), 0.5 * twice_area.norm()});
  }
  return faces;
}

std::vector<MeshEdge> mesh_edges(const Mesh& mesh, const std::vector<FaceShape>& faces) {
  std::vector<MeshEdge> edges;
  std::unordered_map<std::uint64_t, std::size_t> edge_of_pair;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int side = 0; side < 3; ++side) {
      const int a = mesh.triangles[t][side], b = mesh.triangles[t][(side + 1) % 3];
      const std::uint64_t pair = static_cast<std::uint64_t>(std::min(a, b)) << 32 |
                                 static_cast<std::uint64_t>(std::max(a, b));
      const auto [found, is_new] = edge_of_pair.try_emplace(pair, edges.size());
      if (is_new) {
        edges.push_back({{a, b}, {static_cast<int>(t), -1}, 0, false});
        continue;
      }
      MeshEdge& edge = edges[found->second];
      edge.triangles[1] = static_cast<int>(t);
      const Eigen::Vector3d& normal = faces[edge.triangles[0]].normal;
      const int opposite = corner_opposite(mesh.triangles[t], edge.vertices);
      edge.angle = angle_between(normal, faces[t].normal);
      edge.is_convex = normal.dot(mesh.vertices[opposite] - mesh.vertices[a]) < 0;
    }
  }
  return edges;
}

std::vector<SharpVertex> sharp_convex_vertices(const Mesh& mesh,
                                               const std::vector<FaceShape>& faces) {
  struct Round {  // integrals over the directions that leave a vertex along the surface
    double angle = 0;
    double longest_edge = 0;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  };
  std::vector<Round> rounds(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const int vertex = mesh.triangles[t][corner];
      const Eigen::Vector3d u =
          mesh.vertices[mesh.triangles[t][(corner + 1) % 3]] - mesh.vertices[vertex];
      const Eigen::Vector3d v =
          mesh.vertices[mesh.triangles[t][(corner + 2) % 3]] - mesh.vertices[vertex];
      const double angle = angle_between(u, v);
      Round& round = rounds[vertex];
      round.angle += angle;
      round.longest_edge = std::max({round.longest_edge, u.norm(), v.norm()});
      round.normal += angle * faces[t].normal;
      // Integral of the unit direction from u to v.
      round.direction += std::tan(angle / 2) * (u.normalized() + v.normalized());
    }
  }
  std::vector<SharpVertex> sharp;
  for (std::size_t vertex = 0; vertex < rounds.size(); ++vertex) {
    const Round& round = rounds[vertex];
    const double deficit = 2 * std::numbers::pi - round.angle;
    const bool is_used = round.longest_edge > 0;
    if (is_used && deficit > kLeastDeficit && round.direction.dot(round.normal) < 0) {
      sharp.push_back(
          {static_cast<int>(vertex), deficit, round.longest_edge, round.normal.normalized()});
    }
  }
  return sharp;
}

}  // namespace verisim::shape
