// SPDX-License-Identifier: MIT
// Two boxes: separating axes, then the corners of their clipped common face or two edges' closest
// points. Features carry labels, so that a point is known again at the next look.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "dem/surface_contact.h"

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

// Another axis must show less overlap by this share of the smaller box to take over: far below the
// depths that matter, it keeps contacts of two equal faces from flickering.
constexpr double kAxisHysteresis = 1e-6;
// And the last one holds on where it shows more overlap by up to this share.
constexpr double kOverlapMemory = 0.05;
// Two edges closer to parallel than this (rad) leave the contact to faces.
constexpr double kLeastEdgeAngle = 1e-3;
// Faces this close to parallel (cosine, 10 degrees) meet as faces even where two crossing edges
// show less overlap: the edges' one point could not carry a tilt, the clipped face's corners can,
// and their depths differ by less than this cosine.
constexpr double kParallelFaces = 0.985;
// Faces closer to parallel than this (1 - cosine, a thousandth of a radian) share one normal.
constexpr double kOneNormal = 5e-7;
// Edges of two faces that cross at less than this angle (rad) count as parallel.
constexpr double kLeastCrossing = 0.05;
// And where their common normal leans away from the face's by more than this cosine.
constexpr double kSteepestCrossing = 0.5;
// Points closer than this share of the smaller box's half extent are one.
constexpr double kSamePlace = 0.02;

struct Box {
  const BodyState& body;
  Vector3d half;
  Vector3d axis(int i) const { return body.rotation.col(i); }
};

Box box_of(const BodyState& body) { return {body, std::get<BoxShape>(*body.shape).half}; }

double radius_along(const Box& box, const Vector3d& direction) {
  return box.half.dot((box.body.rotation.transpose() * direction).cwiseAbs());
}

struct Separation {
  double gap = -std::numeric_limits<double>::infinity();
  Vector3d normal = Vector3d::UnitZ();  // from a to b
  int axis = -1;
};

/// Separation along `direction` (unit), turned to point from a to b.
Separation separation_along(const Box& a, const Box& b, Vector3d direction, int axis) {
  const Vector3d apart = b.body.position - a.body.position;
  double distance = direction.dot(apart);
  if (distance < 0) {
    direction = -direction;
    distance = -distance;
  }
  return {distance - radius_along(a, direction) - radius_along(b, direction), direction, axis};
}

/// The axis of least overlap or widest gap, of faces alone and of all: faces of a (0-2), of b
/// (3-5), edge pairs (6-14).
struct Separations {
  Separation face, any;
};

/// A later axis must be better by the hysteresis; the last one keeps its place within it.
Separations separations_of(const Box& a, const Box& b, int last_axis) {
  const double step = kAxisHysteresis * std::min(a.half.minCoeff(), b.half.minCoeff());
  Separation best, last;
  const auto offer = [&](const Separation& candidate) {
    if (candidate.axis == last_axis) last = candidate;
    if (candidate.gap > best.gap + (best.axis >= 0 ? step : 0)) best = candidate;
  };
  const auto best_with_memory = [&] {
    const double worse = 2 * step + kOverlapMemory * std::max(0.0, -best.gap);
    return last.axis >= 0 && last.gap > best.gap - worse ? last : best;
  };
  for (int i = 0; i < 3; ++i) offer(separation_along(a, b, a.axis(i), i));
  for (int i = 0; i < 3; ++i) offer(separation_along(a, b, b.axis(i), 3 + i));
  const Separation face = best_with_memory();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vector3d cross = a.axis(i).cross(b.axis(j));
      const double sine = cross.norm();
      if (sine < kLeastEdgeAngle) continue;
      offer(separation_along(a, b, cross / sine, 6 + 3 * i + j));
    }
  }
  return {face, best_with_memory()};
}

/// True if the face along the separation's normal looks at a face that is nearly parallel to it.
bool meets_parallel_face(const Box& a, const Box& b, const Separation& face) {
  const Box& other = face.axis < 3 ? b : a;
  return (other.body.rotation.transpose() * face.normal).cwiseAbs().maxCoeff() > kParallelFaces;
}

/// A corner of a polygon, named by the edges before and after it.
struct Corner {
  Vector3d place;
  int in = 0, out = 0;
};

struct Polygon {
  std::array<Corner, 12> corners;
  int count = 0;
  void add(const Corner& corner) { corners[static_cast<std::size_t>(count++)] = corner; }
};

/// The face of `box` whose outward normal is most opposed to `normal`. Edge labels 0-3.
Polygon opposed_face(const Box& box, const Vector3d& normal, int& face) {
  const Vector3d n_b = box.body.rotation.transpose() * normal;
  int k = 0;
  n_b.cwiseAbs().maxCoeff(&k);
  const double side = n_b[k] > 0 ? -1 : 1;
  face = 2 * k + (side > 0 ? 1 : 0);
  const int u = (k + 1) % 3, v = (k + 2) % 3;
  constexpr std::array<std::array<int, 2>, 4> kSigns{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  Polygon polygon;
  for (int c = 0; c < 4; ++c) {
    Vector3d corner_b;
    corner_b[k] = side * box.half[k];
    corner_b[u] = kSigns[static_cast<std::size_t>(c)][0] * box.half[u];
    corner_b[v] = kSigns[static_cast<std::size_t>(c)][1] * box.half[v];
    polygon.add({box.body.position + box.body.rotation * corner_b, (c + 3) % 4, c});
  }
  return polygon;
}

/// The part of `polygon` with direction . (p - origin) <= limit; new edges get `label`.
Polygon clip(const Polygon& polygon, const Vector3d& direction, const Vector3d& origin,
             double limit, int label) {
  Polygon kept;
  for (int c = 0; c < polygon.count; ++c) {
    const Corner& here = polygon.corners[static_cast<std::size_t>(c)];
    const Corner& next = polygon.corners[static_cast<std::size_t>((c + 1) % polygon.count)];
    const double outside_here = direction.dot(here.place - origin) - limit;
    const double outside_next = direction.dot(next.place - origin) - limit;
    if (outside_here <= 0) kept.add(here);
    if ((outside_here <= 0) == (outside_next <= 0)) continue;
    const double share = outside_here / (outside_here - outside_next);
    const Vector3d crossing = here.place + share * (next.place - here.place);
    if (outside_here <= 0) {
      kept.add({crossing, here.out, label});
    } else {
      kept.add({crossing, label, here.out});
    }
  }
  return kept;
}

std::uint64_t face_point_id(int axis, int face, int in, int out) {
  return (static_cast<std::uint64_t>(axis + 1) << 24) | (static_cast<std::uint64_t>(face) << 16) |
         (static_cast<std::uint64_t>(in) << 8) | static_cast<std::uint64_t>(out);
}

/// Outward normals (of the reference box) where a clipped face and the reference face meet. A
/// corner of the one in the face of the other has that face's normal, two crossing edges have their
/// common normal. So the depth of a point changes by what its normal says, and contacts store
/// energy; with the reference's normal for all of them, sliding on a tilted face would make or eat
/// it.
class CornerNormals {
 public:
  CornerNormals(const Box& reference, const Box& other, int axis, int other_face,
                const Vector3d& outward)
      : reference_(reference), other_(other), axis_(axis), outward_(outward) {
    other_axis_ = other_face / 2;
    facing_ = (other_face % 2 == 0 ? 1.0 : -1.0) * other.axis(other_axis_);
    is_one_normal_ = facing_.dot(outward) > 1 - kOneNormal;
  }

  /// None where two edges cross that are all but parallel: such a crossing runs along them at the
  /// least turn, and the corners at their ends hold what it would.
  std::optional<Vector3d> at(const Corner& corner) const {
    const bool in_is_other = corner.in < 4, out_is_other = corner.out < 4;
    if (in_is_other && out_is_other) return outward_;
    if (!in_is_other && !out_is_other) return is_one_normal_ ? outward_ : facing_;
    const int edge = in_is_other ? corner.in : corner.out;
    const int side = (in_is_other ? corner.out : corner.in) - 4;
    const Vector3d rim = reference_.axis((axis_ + 2 - side / 2) % 3);
    const Vector3d common = rim.cross(other_.axis((other_axis_ + 1 + edge % 2) % 3));
    const double along = common.dot(outward_);
    if (std::abs(along) < kLeastCrossing) return std::nullopt;
    if (is_one_normal_) return outward_;
    const double size = common.norm();
    if (std::abs(along) < kSteepestCrossing * size) return std::nullopt;
    return Vector3d(common / (along < 0 ? -size : size));
  }

 private:
  const Box &reference_, &other_;
  int axis_, other_axis_;
  Vector3d outward_, facing_;
  bool is_one_normal_;
};

/// Corners of the face of `other`, clipped to the prism over the face of `reference` that looks
/// along `outward`. `is_sure`: the boxes overlap least along this face, so something must hold even
/// where no corner lies over it.
void add_face_points(const Box& reference, const Box& other, const Separation& widest,
                     const Vector3d& outward, double margin, bool is_sure, Found& found) {
  const int k = widest.axis % 3;
  const bool is_of_a = widest.axis < 3;
  int face = 0;
  Polygon polygon = opposed_face(other, outward, face);
  for (int side = 0; side < 4 && polygon.count > 0; ++side) {
    const int i = (k + 1 + side / 2) % 3;
    const Vector3d direction = (side % 2 == 0 ? 1.0 : -1.0) * reference.axis(i);
    polygon = clip(polygon, direction, reference.body.position, reference.half[i], 4 + side);
  }
  const auto add = [&](const Vector3d& p, const Vector3d& normal, std::uint64_t id) {
    const double depth = reference.half[k] - outward.dot(p - reference.body.position);
    if (depth <= -margin) return;
    const Vector3d push = is_of_a ? Vector3d(-normal) : normal;
    found.points.push_back({id, p + 0.5 * depth * outward, push, depth * normal.dot(outward), 1});
  };
  const CornerNormals normals(reference, other, k, face, outward);
  for (int c = 0; c < polygon.count; ++c) {
    const Corner& corner = polygon.corners[static_cast<std::size_t>(c)];
    const std::optional<Vector3d> normal = normals.at(corner);
    if (!normal) continue;
    add(corner.place, *normal, face_point_id(widest.axis, face, corner.in, corner.out));
  }
  if (!found.points.empty() || widest.gap >= 0 || !is_sure) return;
  // Overlapping, yet no corner over the face: the corner that reaches farthest in holds.
  const Vector3d n_b = other.body.rotation.transpose() * outward;
  const Vector3d corner_b = -n_b.cwiseSign().cwiseProduct(other.half);
  add(other.body.position + other.body.rotation * corner_b, outward,
      face_point_id(widest.axis, face, 254, 254));
}

/// Middle of the shortest line between two edges; `normal` from a to b.
void add_edge_point(const Box& a, const Box& b, const Separation& widest, double margin,
                    Found& found) {
  const int i = (widest.axis - 6) / 3, j = (widest.axis - 6) % 3;
  const auto edge_middle = [](const Box& box, const Vector3d& towards, int along, int& corner) {
    Vector3d middle_b = (box.body.rotation.transpose() * towards).cwiseSign();
    corner = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == along) {
        middle_b[axis] = 0;
      } else {
        if (middle_b[axis] == 0) middle_b[axis] = 1;
        if (middle_b[axis] > 0) corner |= 1 << axis;
      }
      middle_b[axis] *= box.half[axis];
    }
    return Vector3d(box.body.position + box.body.rotation * middle_b);
  };
  int corner_a = 0, corner_b = 0;
  const Vector3d p = edge_middle(a, widest.normal, i, corner_a);
  const Vector3d q = edge_middle(b, -widest.normal, j, corner_b);
  const Vector3d u = a.axis(i), v = b.axis(j);
  const double cosine = u.dot(v), scale = 1 - cosine * cosine;
  const Vector3d apart = q - p;
  const double along_a =
      std::clamp((apart.dot(u) - cosine * apart.dot(v)) / scale, -a.half[i], a.half[i]);
  const double along_b =
      std::clamp((cosine * apart.dot(u) - apart.dot(v)) / scale, -b.half[j], b.half[j]);
  if (-widest.gap <= -margin) return;
  const Vector3d place = 0.5 * (p + along_a * u + q + along_b * v);
  found.points.push_back(
      {face_point_id(widest.axis, 0, corner_a, corner_b), place, -widest.normal, -widest.gap, 1});
}

}  // namespace

void find_box_points(const BodyState& a, const BodyState& b, double margin, int last_axis,
                     Found& found) {
  const Box box_a = box_of(a), box_b = box_of(b);
  const auto [face, any] = separations_of(box_a, box_b, last_axis);
  found.gap = any.gap;
  found.normal = -any.normal;
  found.axis = any.axis;
  if (any.gap >= margin) return;
  const auto add_points_of_face = [&](bool is_sure) {
    const bool is_of_a = face.axis < 3;
    const Box &reference = is_of_a ? box_a : box_b, &other = is_of_a ? box_b : box_a;
    const Vector3d outward = is_of_a ? face.normal : Vector3d(-face.normal);
    add_face_points(reference, other, face, outward, margin, is_sure, found);
    found.axis = face.axis;
  };
  if (any.axis < 6) {
    add_points_of_face(true);
    return;
  }
  const double along = any.normal.dot(face.normal);
  const double overlap = std::max(0.0, -any.gap);
  if (along > kSteepestCrossing) {
    add_points_of_face(false);
    double deepest = -margin;
    for (const FoundPoint& point : found.points) deepest = std::max(deepest, point.depth);
    // Edges that met at the last look go on: corners that hold now would not without them.
    if (last_axis < 6 && (along > kParallelFaces || meets_parallel_face(box_a, box_b, face)) &&
        !found.points.empty() && deepest >= kParallelFaces * overlap) {
      return;
    }
  }
  const std::size_t num_corners = found.points.size();
  found.axis = any.axis;
  add_edge_point(box_a, box_b, any, margin, found);
  // The corners of the face hold what turns about the edges' one point, but those that are deeper
  // than the boxes overlap. One that is that point lends it its name: faces and edges take turns
  // unnoticed.
  FoundPoint& edge_point = found.points.back();
  const double same_place = kSamePlace * std::min(box_a.half.minCoeff(), box_b.half.minCoeff());
  const double deepest_corner = (1 + kOverlapMemory) * overlap;
  const auto is_out = [&](const FoundPoint& corner) {
    const bool is_edge_point = (corner.place - edge_point.place).norm() < same_place;
    if (is_edge_point) edge_point.id = corner.id;
    return is_edge_point || corner.depth > deepest_corner;
  };
  const auto end_of_corners = found.points.begin() + static_cast<std::ptrdiff_t>(num_corners);
  const auto kept = std::remove_if(found.points.begin(), end_of_corners, is_out);
  found.points.erase(kept, end_of_corners);
}

}  // namespace verisim::dem
