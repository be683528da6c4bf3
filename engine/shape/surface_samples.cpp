// SPDX-License-Identifier: MIT
// Cuts faces and edges along a lattice and joins the pieces that are connected within a cell.
#include "shape/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>
#include <tuple>

#include "shape/extents.h"
#include "shape/sharp_features.h"
#include "shape/triangle_tree.h"

namespace verisim::shape {
namespace {

// Parts of the surface with triangles or edges this small beside the lattice are joined across
// sharp edges too, or a rough fine mesh would get a sample per triangle.
constexpr double kSmallArea = 0.5;    // of spacing^2
constexpr double kSmallLength = 0.5;  // of spacing
// Pieces cut off by rounding: less than this share of the triangle or edge.
constexpr double kNothing = 1e-12;
constexpr double kFlatAngle = 1e-6;  // rad, between triangles of one flat face
// Between large flat faces: 3 degrees. A blunter edge rises by less than 1/40 of the way to it.
constexpr double kBluntAngle = 0.0523598775598299;  // rad

using Polygon = std::vector<Eigen::Vector3d>;

struct Lattice {
  Eigen::Vector3d low;   // m
  Eigen::Vector3d cell;  // m, at most the spacing
  Eigen::Vector3i count;
  double spacing;  // m

  // Places on the outer faces belong to the outermost cells, whatever their rounding.
  int index(int axis, double place) const {
    const double cells = std::floor((place - low[axis]) / cell[axis]);
    return static_cast<int>(std::clamp(cells, 0.0, count[axis] - 1.0));
  }
  double place(int axis, int index) const { return low[axis] + cell[axis] * index; }
};

Lattice lattice_over(const Mesh& mesh, double spacing) {
  const Eigen::AlignedBox3d box = bounding_box(mesh);
  constexpr double kRoundingSlack = 1e-6;  // 4.0000001 cells are 4
  const Eigen::Array3d count =
      (box.sizes() / spacing * (1 - kRoundingSlack)).array().ceil().max(1.0);
  return {box.min(), box.sizes().array() / count, count.matrix().cast<int>(), spacing};
}

// The axis of the largest component; the first of those that are equal up to rounding.
int dominant_axis(const Eigen::Vector3d& v) {
  const Eigen::Vector3d size = v.cwiseAbs();
  const double limit = size.maxCoeff() * (1 - 1e-6);
  return size.x() >= limit ? 0 : size.y() >= limit ? 1 : 2;
}

// Sets that grow together; each is named by its smallest member.
class JoinedSets {
 public:
  explicit JoinedSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t find(std::size_t member) {
    while (parent_[member] != member) member = parent_[member] = parent_[parent_[member]];
    return member;
  }
  void join(std::size_t a, std::size_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

// The part of the convex polygon with coordinate `axis` at least (keep_above) or at most `place`.
Polygon cut(const Polygon& polygon, int axis, double place, bool keep_above) {
  Polygon kept;
  const auto depth = [&](const Eigen::Vector3d& p) {
    return keep_above ? p[axis] - place : place - p[axis];
  };
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    const Eigen::Vector3d& from = polygon[n];
    const Eigen::Vector3d& to = polygon[(n + 1) % polygon.size()];
    const double depth_from = depth(from), depth_to = depth(to);
    if (depth_from >= 0) kept.push_back(from);
    if ((depth_from > 0 && depth_to < 0) || (depth_from < 0 && depth_to > 0)) {
      kept.push_back(from + depth_from / (depth_from - depth_to) * (to - from));
      kept.back()[axis] = place;
    }
  }
  return kept;
}

// Calls visit(index, part) for each slab of the lattice across `axis` that the polygon enters.
template <typename Visit>
void for_each_slab(const Polygon& polygon, const Lattice& lattice, int axis, Visit visit) {
  const auto [low, high] =
      std::minmax_element(polygon.begin(), polygon.end(),
                          [&](const auto& p, const auto& q) { return p[axis] < q[axis]; });
  const int first = lattice.index(axis, (*low)[axis]), last = lattice.index(axis, (*high)[axis]);
  Polygon rest = polygon;
  for (int index = first; index < last && rest.size() > 1; ++index) {
    const double place = lattice.place(axis, index + 1);
    visit(index, cut(rest, axis, place, false));
    rest = cut(rest, axis, place, true);
  }
  visit(last, rest);
}

// Does the segment pass through the cell (i, j) of the lattice across axes u and v?
bool crosses_column(Eigen::Vector3d a, Eigen::Vector3d b, const Lattice& lattice, int u, int i,
                    int v, int j) {
  for (const auto& [axis, index] : {std::pair(u, i), std::pair(v, j)}) {
    const double slack = 1e-9 * lattice.cell[axis];
    const double low = lattice.place(axis, index) - slack;
    const double high = lattice.place(axis, index + 1) + slack;
    const Polygon part = cut(cut({a, b}, axis, low, true), axis, high, false);
    if (part.empty()) return false;
    a = part.front();
    b = part[part.size() > 1 ? 1 : 0];  // later points repeat these two
  }
  return true;
}

// ---- flat faces

struct FlatFaces {
  std::vector<std::size_t> of_triangle;
  std::vector<bool> is_large;  // at least 3 x 3 squares of the lattice
};

FlatFaces find_flat_faces(const std::vector<FaceShape>& faces, const std::vector<MeshEdge>& edges,
                          double spacing) {
  JoinedSets sets(faces.size());
  for (const MeshEdge& edge : edges) {
    if (edge.triangles[1] < 0 || edge.angle > kFlatAngle) continue;
    sets.join(static_cast<std::size_t>(edge.triangles[0]),
              static_cast<std::size_t>(edge.triangles[1]));
  }
  FlatFaces flat;
  std::vector<double> area(faces.size(), 0);
  for (std::size_t t = 0; t < faces.size(); ++t) {
    flat.of_triangle.push_back(sets.find(t));
    area[flat.of_triangle[t]] += faces[t].area;
  }
  for (const double a : area) flat.is_large.push_back(a >= 9 * spacing * spacing);
  return flat;
}

// The edges that count as such: sharp ones, and blunt ones of two large flat faces, which are no
// part of a curved surface.
std::vector<bool> find_marked(const std::vector<MeshEdge>& edges, const FlatFaces& flat) {
  const auto is_large = [&](int triangle) {
    return triangle >= 0 && flat.is_large[flat.of_triangle[static_cast<std::size_t>(triangle)]];
  };
  std::vector<bool> marked;
  for (const MeshEdge& edge : edges) {
    const bool is_blunt =
        edge.angle > kBluntAngle && is_large(edge.triangles[0]) && is_large(edge.triangles[1]);
    marked.push_back(edge.is_sharp() || is_blunt);
  }
  return marked;
}

// The large flat faces whose edges are all marked.
std::vector<bool> find_framed(const std::vector<MeshEdge>& edges, const std::vector<bool>& marked,
                              const FlatFaces& flat) {
  std::vector<bool> framed = flat.is_large;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (marked[e] || (edges[e].triangles[1] >= 0 && edges[e].angle <= kFlatAngle)) continue;
    for (const int triangle : edges[e].triangles) {
      if (triangle >= 0) framed[flat.of_triangle[static_cast<std::size_t>(triangle)]] = false;
    }
  }
  return framed;
}

// ---- faces

struct FacePiece {
  std::array<int, 4> column;  // dominant axis, its sign, lattice indices along the next two axes
  int triangle;
  Polygon polygon;
  double area;
  Eigen::Vector3d center;

  auto order() const { return std::tie(column, triangle); }
};

void measure(const Eigen::Vector3d& normal, FacePiece& piece) {
  piece.area = 0;
  piece.center.setZero();
  const Polygon& p = piece.polygon;
  for (std::size_t n = 2; n < p.size(); ++n) {
    const double area = 0.5 * normal.dot((p[n - 1] - p[0]).cross(p[n] - p[0]));
    piece.area += area;
    piece.center += area / 3 * (p[0] + p[n - 1] + p[n]);
  }
  if (piece.area > 0) piece.center /= piece.area;
}

std::vector<FacePiece> cut_faces(const Mesh& mesh, const std::vector<FaceShape>& faces,
                                 const Lattice& lattice) {
  std::vector<FacePiece> pieces;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!(faces[t].area > 0)) continue;
    const auto& [a, b, c] = mesh.triangles[t];
    const Eigen::Vector3d& normal = faces[t].normal;
    const int axis = dominant_axis(normal), u = (axis + 1) % 3, v = (axis + 2) % 3;
    const Polygon whole{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
    for_each_slab(whole, lattice, u, [&](int i, const Polygon& strip) {
      if (strip.size() < 3) return;
      for_each_slab(strip, lattice, v, [&](int j, const Polygon& part) {
        FacePiece piece{{axis, normal[axis] > 0, i, j}, static_cast<int>(t), part, 0, {}};
        measure(normal, piece);
        if (piece.area > kNothing * faces[t].area) pieces.push_back(std::move(piece));
      });
    });
  }
  std::sort(pieces.begin(), pieces.end(),
            [](const FacePiece& p, const FacePiece& q) { return p.order() < q.order(); });
  return pieces;
}

// Joins pieces of one column whose triangles share an edge there that is not sharp.
JoinedSets join_faces(const Mesh& mesh, const std::vector<FaceShape>& faces,
                      const std::vector<MeshEdge>& edges, const Lattice& lattice,
                      const std::vector<FacePiece>& pieces) {
  const double small_area = kSmallArea * lattice.spacing * lattice.spacing;
  std::vector<std::vector<const MeshEdge*>> edges_of_triangle(faces.size());
  for (const MeshEdge& edge : edges) {
    if (edge.triangles[1] < 0) continue;
    const auto [s, t] = edge.triangles;
    if (edge.is_sharp() && std::min(faces[s].area, faces[t].area) > small_area) continue;
    edges_of_triangle[s].push_back(&edge);
  }
  JoinedSets sets(pieces.size());
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const auto [axis, sign, i, j] = pieces[p].column;
    for (const MeshEdge* edge : edges_of_triangle[pieces[p].triangle]) {
      const auto wanted = std::tie(pieces[p].column, edge->triangles[1]);
      const auto other =
          std::lower_bound(pieces.begin(), pieces.end(), wanted,
                           [](const FacePiece& q, const auto& key) { return q.order() < key; });
      if (other == pieces.end() || other->order() != wanted) continue;
      if (crosses_column(mesh.vertices[edge->vertices[0]], mesh.vertices[edge->vertices[1]],
                         lattice, (axis + 1) % 3, i, (axis + 2) % 3, j)) {
        sets.join(p, static_cast<std::size_t>(other - pieces.begin()));
      }
    }
  }
  return sets;
}

// A sample from pieces, weights and centres; closest(piece, point) is on the piece.
struct Cluster {
  double weight = 0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  std::vector<std::size_t> pieces;

  void add(std::size_t piece, double piece_weight, const Eigen::Vector3d& center,
           const Eigen::Vector3d& piece_normal) {
    weight += piece_weight;
    moment += piece_weight * center;
    normal += piece_weight * piece_normal;
    pieces.push_back(piece);
  }
};

template <typename Closest>  // Closest(piece, point) -> point on the piece
Eigen::Vector3d place_on_pieces(const Cluster& cluster, Closest closest) {
  const Eigen::Vector3d center = cluster.moment / cluster.weight;
  Eigen::Vector3d best = center;
  double least = INFINITY;
  for (std::size_t piece : cluster.pieces) {
    const Eigen::Vector3d point = closest(piece, center);
    const double squared = (point - center).squaredNorm();
    if (squared < least) std::tie(least, best) = std::pair(squared, point);
  }
  return best;
}

void sample_faces(const Mesh& mesh, const std::vector<FaceShape>& faces,
                  const std::vector<MeshEdge>& edges, const FlatFaces& flat,
                  const std::vector<bool>& framed, const Lattice& lattice,
                  std::vector<SurfaceSample>& samples) {
  const std::vector<FacePiece> pieces = cut_faces(mesh, faces, lattice);
  JoinedSets sets = join_faces(mesh, faces, edges, lattice, pieces);
  std::map<std::size_t, Cluster> clusters;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    clusters[sets.find(p)].add(p, pieces[p].area, pieces[p].center,
                               faces[pieces[p].triangle].normal);
  }
  for (const auto& [name, cluster] : clusters) {
    const auto closest = [&](std::size_t piece, const Eigen::Vector3d& point) {
      const Polygon& polygon = pieces[piece].polygon;
      Eigen::Vector3d best = polygon[0];
      for (std::size_t n = 2; n < polygon.size(); ++n) {
        const Eigen::Vector3d other =
            closest_on_triangle(point, polygon[0], polygon[n - 1], polygon[n]);
        if ((other - point).squaredNorm() < (best - point).squaredNorm()) best = other;
      }
      return best;
    };
    const bool is_framed =
        std::all_of(cluster.pieces.begin(), cluster.pieces.end(), [&](std::size_t piece) {
          return framed[flat.of_triangle[static_cast<std::size_t>(pieces[piece].triangle)]];
        });
    samples.push_back({place_on_pieces(cluster, closest), cluster.normal.normalized(),
                       cluster.weight, 0, false, is_framed});
  }
}

// ---- edges

struct EdgePiece {
  std::array<int, 2> slab;  // dominant axis, lattice index along it
  std::array<int, 3> cell;  // of its middle
  int edge;
  Eigen::Vector3d from, to;
  std::array<int, 2> ends;  // mesh vertices, -1 where cut
};

std::vector<EdgePiece> cut_edges(const Mesh& mesh, const std::vector<MeshEdge>& edges,
                                 const std::vector<bool>& marked, const Lattice& lattice) {
  std::vector<EdgePiece> pieces;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const MeshEdge& edge = edges[e];
    if (!marked[e] || !edge.is_convex) continue;
    const Eigen::Vector3d& a = mesh.vertices[edge.vertices[0]];
    const Eigen::Vector3d& b = mesh.vertices[edge.vertices[1]];
    const int axis = dominant_axis(b - a);
    for_each_slab({a, b}, lattice, axis, [&](int slab, const Polygon& part) {
      if (part.size() < 2) return;
      // A cut segment can come out in either direction, with the cut point twice.
      const Eigen::Vector3d &from = part.front(), &to = part[1];
      if (!((to - from).norm() > kNothing * (b - a).norm())) return;
      const Eigen::Vector3d middle = 0.5 * (from + to);
      EdgePiece piece{{axis, slab}, {}, static_cast<int>(e), from, to, {-1, -1}};
      for (int n = 0; n < 3; ++n) piece.cell[n] = lattice.index(n, middle[n]);
      for (int end = 0; end < 2; ++end) {
        const Eigen::Vector3d& vertex = mesh.vertices[edge.vertices[end]];
        if (from == vertex || to == vertex) piece.ends[end] = edge.vertices[end];
      }
      pieces.push_back(piece);
    });
  }
  return pieces;
}

// Joins pieces that meet at a vertex: those of one slab that run on straight, and short ones of one
// cell.
JoinedSets join_edges(const Mesh& mesh, const std::vector<MeshEdge>& edges, const Lattice& lattice,
                      const std::vector<EdgePiece>& pieces) {
  std::map<int, std::vector<std::size_t>> meeting;  // by vertex
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    for (int vertex : pieces[p].ends) {
      if (vertex >= 0) meeting[vertex].push_back(p);
    }
  }
  JoinedSets sets(pieces.size());
  for (const auto& entry : meeting) {
    const int vertex = entry.first;
    const std::vector<std::size_t>& members = entry.second;
    const auto leaving = [&](std::size_t p) -> Eigen::Vector3d {
      const auto [a, b] = edges[pieces[p].edge].vertices;
      return mesh.vertices[a == vertex ? b : a] - mesh.vertices[vertex];
    };
    for (std::size_t m = 0; m < members.size(); ++m) {
      for (std::size_t n = m + 1; n < members.size(); ++n) {
        const Eigen::Vector3d u = leaving(members[m]), v = leaving(members[n]);
        const EdgePiece &p = pieces[members[m]], &q = pieces[members[n]];
        const bool is_straight =
            p.slab == q.slab && -u.dot(v) > std::cos(kSharpAngle) * u.norm() * v.norm();
        const bool is_short =
            p.cell == q.cell && std::min(u.norm(), v.norm()) < kSmallLength * lattice.spacing;
        if (is_straight || is_short) sets.join(members[m], members[n]);
      }
    }
  }
  return sets;
}

void sample_edges(const Mesh& mesh, const std::vector<FaceShape>& faces,
                  const std::vector<MeshEdge>& edges, const std::vector<bool>& marked,
                  const Lattice& lattice, std::vector<SurfaceSample>& samples) {
  const std::vector<EdgePiece> pieces = cut_edges(mesh, edges, marked, lattice);
  JoinedSets sets = join_edges(mesh, edges, lattice, pieces);
  std::map<std::size_t, Cluster> clusters;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const auto [s, t] = edges[pieces[p].edge].triangles;
    clusters[sets.find(p)].add(p, (pieces[p].to - pieces[p].from).norm(),
                               0.5 * (pieces[p].from + pieces[p].to),
                               (faces[s].normal + faces[t].normal).normalized());
  }
  for (const auto& [name, cluster] : clusters) {
    const auto closest = [&](std::size_t piece, const Eigen::Vector3d& point) {
      return closest_on_triangle(point, pieces[piece].from, pieces[piece].to, pieces[piece].to);
    };
    samples.push_back(
        {place_on_pieces(cluster, closest), cluster.normal.normalized(), 0, cluster.weight, false});
  }
}

// ---- corners

void sample_corners(const Mesh& mesh, const std::vector<FaceShape>& faces, const Lattice& lattice,
                    std::vector<SurfaceSample>& samples) {
  const std::vector<SharpVertex> corners = sharp_convex_vertices(mesh, faces);
  // Of the corners amid short edges, the sharpest in each cell.
  std::map<std::array<int, 3>, const SharpVertex*> sharpest;
  std::vector<const SharpVertex*> kept;
  for (const SharpVertex& corner : corners) {
    if (corner.longest_edge >= kSmallLength * lattice.spacing) {
      kept.push_back(&corner);
      continue;
    }
    const Eigen::Vector3d& place = mesh.vertices[corner.vertex];
    const SharpVertex*& best = sharpest[{lattice.index(0, place.x()), lattice.index(1, place.y()),
                                         lattice.index(2, place.z())}];
    if (best == nullptr || corner.deficit > best->deficit) best = &corner;
  }
  for (const auto& [cell, corner] : sharpest) kept.push_back(corner);
  for (const SharpVertex* corner : kept) {
    samples.push_back({mesh.vertices[corner->vertex], corner->mean_normal, 0, 0, true});
  }
}

}  // namespace

std::vector<SurfaceSample> sample_surface(const Mesh& mesh, double spacing) {
  const std::vector<FaceShape> faces = face_shapes(mesh);
  double area = 0;
  for (const FaceShape& face : faces) area += face.area;
  if (!(spacing > 0) || !(area <= kMaxNumSurfaceSamples * spacing * spacing)) {
    std::ostringstream message;
    message << "surface samples " << spacing << " m apart on " << area << " m^2 are more than "
            << kMaxNumSurfaceSamples << "\nhint: use a spacing of "
            << std::sqrt(area / kMaxNumSurfaceSamples) << " m or more";
    throw MeshError(message.str());
  }
  const Lattice lattice = lattice_over(mesh, spacing);
  const std::vector<MeshEdge> edges = mesh_edges(mesh, faces);
  std::vector<SurfaceSample> samples;
  const FlatFaces flat = find_flat_faces(faces, edges, spacing);
  const std::vector<bool> marked = find_marked(edges, flat);
  sample_faces(mesh, faces, edges, flat, find_framed(edges, marked, flat), lattice, samples);
  sample_edges(mesh, faces, edges, marked, lattice, samples);
  sample_corners(mesh, faces, lattice, samples);
  return samples;
}

}  // namespace verisim::shape
