// SPDX-License-Identifier: MIT
// Checks that a triangle mesh is the closed, outward-facing surface of a solid.
#include "shape/check_mesh.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "shape/extents.h"
#include "shape/mass_properties.h"

namespace verisim::shape {
namespace {

// Thinner than this share of its diagonal, a mesh read with 32-bit coordinates (6e-8) has no
// trustworthy inside.
constexpr double kFlatness = 1e-6;

// Counts one kind of problem and remembers where it was first seen.
struct Tally {
  std::string code;
  std::string what;
  std::string hint;
  long count = 0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();

  void add(const Eigen::Vector3d& where) {
    if (count++ == 0) place = where;
  }

  void report(std::vector<MeshProblem>& problems) const {
    if (count == 0) return;
    std::ostringstream message;
    message << code << ": " << count << ' ' << what << ", the first at " << point_text(place)
            << "; hint: " << hint;
    problems.push_back({code, count, place, message.str()});
  }
};

struct HalfEdge {
  int low, high;  // vertex indices, low < high
  bool forward;   // runs from low to high
};

bool check_indices(const Mesh& mesh, std::vector<MeshProblem>& problems) {
  if (mesh.triangles.empty()) {
    problems.push_back({"no_triangles", 0, Eigen::Vector3d::Zero(),
                        "no_triangles: the mesh is empty; hint: export faces, not only points"});
    return false;
  }
  Tally bad_index{"bad_index", "triangle(s) name a vertex that does not exist",
                  "indices run from 0 to the number of vertices less 1"};
  const int num_vertices = static_cast<int>(mesh.vertices.size());
  for (const auto& triangle : mesh.triangles) {
    const auto [low, high] = std::minmax_element(triangle.begin(), triangle.end());
    if (*low < 0 || *high >= num_vertices) bad_index.add(Eigen::Vector3d::Zero());
  }
  bad_index.report(problems);
  return bad_index.count == 0;
}

bool check_finite(const Mesh& mesh, std::vector<MeshProblem>& problems) {
  Tally nonfinite{"nonfinite", "vertex(es) with NaN or infinity", "repair or re-export the mesh"};
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    if (!vertex.allFinite()) nonfinite.add(vertex);
  }
  nonfinite.report(problems);
  return nonfinite.count == 0;
}

bool is_degenerate(const std::array<int, 3>& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

std::vector<HalfEdge> sorted_half_edges(const Mesh& mesh) {
  std::vector<HalfEdge> half_edges;
  half_edges.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    if (is_degenerate(triangle)) continue;
    for (int corner = 0; corner < 3; ++corner) {
      const int from = triangle[corner];
      const int to = triangle[(corner + 1) % 3];
      half_edges.push_back({std::min(from, to), std::max(from, to), from < to});
    }
  }
  std::sort(half_edges.begin(), half_edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::pair(a.low, a.high) < std::pair(b.low, b.high);
  });
  return half_edges;
}

// Every edge must have exactly one half-edge in each direction.
bool check_edges(const Mesh& mesh, std::vector<MeshProblem>& problems) {
  Tally degenerate{"degenerate_triangle", "triangle(s) with the same corner twice",
                   "delete zero-area triangles in a mesh editor"};
  Tally open{"open_edge", "edge(s) belong to one triangle only",
             "fill the holes, and join vertices that should be the same"};
  Tally overused{"overused_edge", "edge(s) belong to more than two triangles",
                 "remove inner walls and duplicate triangles; separate parts that touch"};
  Tally mismatched{"mismatched_winding", "edge(s) whose two triangles face opposite ways",
                   "recalculate normals to point outside"};
  for (const auto& triangle : mesh.triangles) {
    if (is_degenerate(triangle)) degenerate.add(mesh.vertices[triangle[0]]);
  }
  const std::vector<HalfEdge> half_edges = sorted_half_edges(mesh);
  for (std::size_t begin = 0, end = 0; begin < half_edges.size(); begin = end) {
    int num_forward = 0;
    int num_backward = 0;
    for (end = begin; end < half_edges.size() && half_edges[end].low == half_edges[begin].low &&
                      half_edges[end].high == half_edges[begin].high;
         ++end) {
      ++(half_edges[end].forward ? num_forward : num_backward);
    }
    const Eigen::Vector3d middle =
        0.5 * (mesh.vertices[half_edges[begin].low] + mesh.vertices[half_edges[begin].high]);
    if (num_forward + num_backward == 1) {
      open.add(middle);
    } else if (num_forward + num_backward > 2) {
      overused.add(middle);
    } else if (num_forward != num_backward) {
      mismatched.add(middle);
    }
  }
  for (const Tally* tally : {&degenerate, &open, &overused, &mismatched}) tally->report(problems);
  return open.count + overused.count + mismatched.count == 0;
}

// Root mean square distance of the vertices from the plane that fits them best.
double thickness_about_best_plane(const Mesh& mesh, const Eigen::Vector3d& mean) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    spread += (vertex - mean) * (vertex - mean).transpose();
  }
  const Eigen::Vector3d normal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  double sum = 0;  // from distances, not from the eigenvalue, which loses half the digits
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    sum += std::pow(normal.dot(vertex - mean), 2);
  }
  return std::sqrt(sum / static_cast<double>(mesh.vertices.size()));
}

double surface_area(const Mesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d& a = mesh.vertices[t[0]];
    area += 0.5 * (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm();
  }
  return area;
}

void check_volume(const Mesh& mesh, bool is_closed, std::vector<MeshProblem>& problems) {
  const double diagonal = bounding_box(mesh).diagonal().norm();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& vertex : mesh.vertices) mean += vertex;
  mean /= static_cast<double>(mesh.vertices.size());

  const double volume = signed_volume(mesh);
  // A plate of thickness t and area A on both sides together holds t A / 2.
  const bool holds_nothing =
      is_closed && std::abs(volume) <= 0.5 * kFlatness * diagonal * surface_area(mesh);
  if (holds_nothing || thickness_about_best_plane(mesh, mean) <= kFlatness * diagonal) {
    std::ostringstream message;
    message << "flat: the mesh encloses no volume (" << volume << " m^3 over a size of " << diagonal
            << " m), centre " << point_text(mean) << "; hint: give it thickness";
    problems.push_back({"flat", 1, mean, message.str()});
  } else if (is_closed && volume < 0) {
    std::ostringstream message;
    message << "inside_out: all " << mesh.triangles.size() << " triangles together enclose "
            << volume << " m^3, centre " << point_text(mean)
            << "; hint: flip the normals so that they point outside";
    problems.push_back(
        {"inside_out", static_cast<long>(mesh.triangles.size()), mean, message.str()});
  }
}

}  // namespace

std::vector<MeshProblem> check_mesh(const Mesh& mesh) {
  std::vector<MeshProblem> problems;
  if (!check_indices(mesh, problems) || !check_finite(mesh, problems)) return problems;
  const bool is_closed = check_edges(mesh, problems);
  check_volume(mesh, is_closed, problems);
  return problems;
}

void require_solid(const Mesh& mesh, const std::string& file) {
  const std::vector<MeshProblem> problems = check_mesh(mesh);
  if (problems.empty()) return;
  std::string message = file + ": not the closed surface of a solid (" +
                        std::to_string(problems.size()) + " kind(s) of problem)";
  for (const MeshProblem& problem : problems) message += "\n  " + problem.message;
  throw MeshError(message);
}

}  // namespace verisim::shape
