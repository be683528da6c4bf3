// SPDX-License-Identifier: MIT
// Contact points of every pair of shapes but two boxes.
#include "dem/surface_contact.h"

#include <algorithm>
#include <cmath>

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

// Points of a pair come from either side; those of b are told apart by this bit.
constexpr std::uint64_t kOfB = std::uint64_t{1} << 40;

Vector3d up_of(const BodyState& plane) { return plane.rotation.col(2); }

/// Distance of a world point above a plane (m).
double height_above(const BodyState& plane, const Vector3d& p) {
  return up_of(plane).dot(p - plane.position);
}

void set_gap(Found& found, double gap, const Vector3d& normal, bool is_along_normal) {
  found.gap = gap;
  found.normal = normal;
  found.is_along_normal = is_along_normal;
}

/// The one point of a sphere `distance` above a surface with `normal` towards it.
void add_sphere_point(const BodyState& sphere, double radius, double distance,
                      const Vector3d& normal, double margin, bool is_along_normal, Found& found) {
  const double depth = radius - distance;
  set_gap(found, -depth, normal, is_along_normal);
  if (depth <= -margin) return;
  found.points.push_back({1, sphere.position - (radius - 0.5 * depth) * normal, normal, depth, 1});
}

struct Distance {
  double value;
  Vector3d direction;  // away from the surface, unit
};

/// Signed distance of a point to a box, both in the box's frame; exact.
Distance distance_to_box(const Vector3d& half, const Vector3d& p_b) {
  const Vector3d beyond = p_b.cwiseAbs() - half;
  const Vector3d sign(p_b.x() < 0 ? -1 : 1, p_b.y() < 0 ? -1 : 1, p_b.z() < 0 ? -1 : 1);
  int k = 0;
  const double inside = beyond.maxCoeff(&k);
  if (inside <= 0) return {inside, sign[k] * Vector3d::Unit(k)};
  const Vector3d outside = beyond.cwiseMax(0);
  const double value = outside.norm();
  return {value, outside.cwiseProduct(sign) / value};
}

/// Signed distance of a world point to a box or a mesh.
Distance distance_to(const BodyState& body, const Vector3d& p) {
  const Vector3d p_b = body.to_body(p);
  Distance distance;
  if (const auto* box = std::get_if<BoxShape>(body.shape)) {
    distance = distance_to_box(box->half, p_b);
  } else {
    const DistanceValue value = distance_at(std::get<MeshShape>(*body.shape).surface->field, p_b);
    const double slope = value.gradient.norm();
    distance = {value.value, slope > 0 ? Vector3d(value.gradient / slope) : Vector3d::UnitZ()};
  }
  distance.direction = body.rotation * distance.direction;
  return distance;
}

const MeshSurface* surface_of(const BodyState& body) {
  if (const auto* mesh = std::get_if<MeshShape>(body.shape)) return mesh->surface.get();
  return std::get<BoxShape>(*body.shape).surface.get();
}

/// Distances of points in the frame of one body to another that is a box or a mesh.
class FromBody {
 public:
  using Place = Vector3d;  // m, frame of the other body
  FromBody(const BodyState& sampled, const BodyState& other)
      : other_(other),
        turn_(other.rotation.transpose() * sampled.rotation),
        shift_(other.to_body(sampled.position)) {
    if (const auto* mesh = std::get_if<MeshShape>(other.shape)) {
      field_ = &mesh->surface->field;
      const auto [nx, ny, nz] = field_->counts;
      const Vector3d half = 0.5 * field_->spacing * Vector3d(nx - 1, ny - 1, nz - 1);
      middle_ = field_->origin_b + half;
      half_ = half;
    } else {
      half_ = std::get<BoxShape>(*other.shape).half;
    }
  }

  Place place_of(const Vector3d& p_b) const { return turn_ * p_b + shift_; }
  /// Lower bound that costs little, of what is not near the other's bounding box.
  double at_least(const Place& place) const {
    return ((place - middle_).cwiseAbs() - half_).cwiseMax(0).norm();
  }
  double value_at(const Place& place) const { return distance_at(place).value; }
  /// Away from the other body; world frame, unit.
  Vector3d direction_at(const Place& place) const {
    return other_.rotation * distance_at(place).direction;
  }

 private:
  Distance distance_at(const Place& place) const {
    if (field_ == nullptr) return distance_to_box(half_, place);
    const DistanceValue found = dem::distance_at(*field_, place);
    const double slope = found.gradient.norm();
    return {found.value, slope > 0 ? Vector3d(found.gradient / slope) : Vector3d::UnitZ()};
  }

  const BodyState& other_;
  const DistanceField* field_ = nullptr;  // none: a box
  Eigen::Matrix3d turn_;
  Vector3d shift_;
  Vector3d middle_ = Vector3d::Zero(), half_;
};

/// The same above a plane.
class FromPlane {
 public:
  using Place = double;  // m, height
  FromPlane(const BodyState& sampled, const BodyState& plane)
      : up_(up_of(plane)),
        up_b_(sampled.rotation.transpose() * up_),
        height_(height_above(plane, sampled.position)) {}

  Place place_of(const Vector3d& p_b) const { return height_ + up_b_.dot(p_b); }
  double at_least(Place place) const { return place; }
  double value_at(Place place) const { return place; }
  const Vector3d& direction_at(Place) const { return up_; }

 private:
  Vector3d up_, up_b_;
  double height_;
};

/// Surface points of `sampled` against another body. Blocks that are too far are skipped whole.
template <class From>
void add_surface_points(const BodyState& sampled, const From& from, double margin,
                        std::uint64_t id_of_side, double push_sign, Found& found) {
  const MeshSurface& surface = *surface_of(sampled);
  const int num_blocks = static_cast<int>(surface.blocks.size());
  for (int b = 0; b < num_blocks;) {
    const SurfaceBlock& block = surface.blocks[static_cast<std::size_t>(b)];
    const bool has_parts = block.next > b + 1;
    const auto centre = from.place_of(block.centre_b);
    if (from.at_least(centre) - block.radius >= std::max(margin, found.gap)) {
      b = block.next;
      continue;
    }
    const double nearest = from.value_at(centre) - block.radius;
    if (nearest >= margin && (!has_parts || nearest >= found.gap)) {
      if (nearest < found.gap) {
        found.gap = nearest;
        found.normal = push_sign * from.direction_at(centre);
      }
      b = block.next;
      continue;
    }
    ++b;
    if (has_parts) continue;
    for (int i = block.first; i < block.first + block.count; ++i) {
      const SurfacePoint& point = surface.points[static_cast<std::size_t>(i)];
      const auto place = from.place_of(point.position_b);
      const double distance = from.value_at(place);
      if (distance >= margin && distance >= found.gap) continue;
      const Vector3d push = push_sign * from.direction_at(place);
      if (distance < found.gap) {
        found.gap = distance;
        found.normal = push;
      }
      if (distance >= margin) continue;
      found.points.push_back({id_of_side | static_cast<std::uint64_t>(i + 1),
                              sampled.position + sampled.rotation * point.position_b, push,
                              -distance, point.weight});
    }
  }
}

void find_corner_points(const BodyState& box, const BodyState& plane, double margin, Found& found) {
  const Vector3d& half = std::get<BoxShape>(*box.shape).half;
  const Vector3d up = up_of(plane);
  set_gap(found, std::numeric_limits<double>::infinity(), up, true);
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d corner_b((corner & 1) != 0 ? half.x() : -half.x(),
                            (corner & 2) != 0 ? half.y() : -half.y(),
                            (corner & 4) != 0 ? half.z() : -half.z());
    const Vector3d p = box.position + box.rotation * corner_b;
    const double height = height_above(plane, p);
    found.gap = std::min(found.gap, height);
    if (height >= margin) continue;
    found.points.push_back({static_cast<std::uint64_t>(corner + 1), p, up, -height, 1});
  }
}

void find_surface_points_on_plane(const BodyState& body, const BodyState& plane, double margin,
                                  Found& found) {
  set_gap(found, std::numeric_limits<double>::infinity(), up_of(plane), true);
  add_surface_points(body, FromPlane(body, plane), margin, 0, 1, found);
}

void find_surface_points(const BodyState& a, const BodyState& b, double margin, Found& found) {
  set_gap(found, std::numeric_limits<double>::infinity(), Vector3d::UnitZ(), false);
  const double apart = (a.position - b.position).norm() - a.reach - b.reach;
  if (apart >= margin) {
    set_gap(found, apart, (a.position - b.position).normalized(), false);
    return;
  }
  add_surface_points(a, FromBody(a, b), margin, 0, 1, found);
  add_surface_points(b, FromBody(b, a), margin, kOfB, -1, found);
}

void find_sphere_points(const BodyState& sphere, const BodyState& other, double margin,
                        Found& found) {
  const double radius = std::get<SphereShape>(*sphere.shape).radius;
  if (std::holds_alternative<PlaneShape>(*other.shape)) {
    add_sphere_point(sphere, radius, height_above(other, sphere.position), up_of(other), margin,
                     true, found);
  } else if (const auto* ball = std::get_if<SphereShape>(other.shape)) {
    const Vector3d apart = sphere.position - other.position;
    const double distance = apart.norm();
    const Vector3d normal = distance > 0 ? Vector3d(apart / distance) : Vector3d::UnitZ();
    const double depth = radius + ball->radius - distance;
    set_gap(found, -depth, normal, true);
    if (depth <= -margin) return;
    found.points.push_back(
        {1, other.position + (ball->radius - 0.5 * depth) * normal, normal, depth, 1});
  } else {
    const Distance distance = distance_to(other, sphere.position);
    const bool is_convex = std::holds_alternative<BoxShape>(*other.shape);
    add_sphere_point(sphere, radius, distance.value, distance.direction, margin, is_convex, found);
  }
}

/// Which of two shapes comes first: the one whose surface is looked at point by point.
int rank(const CollisionShape& shape) {
  if (std::holds_alternative<SphereShape>(shape)) return 3;
  if (std::holds_alternative<MeshShape>(shape)) return 2;
  return std::holds_alternative<BoxShape>(shape) ? 1 : 0;
}

}  // namespace

bool is_in_order(const CollisionShape& a, const CollisionShape& b) { return rank(a) >= rank(b); }

void find_points(const BodyState& a, const BodyState& b, double margin, int last_axis,
                 Found& found) {
  found.points.clear();
  found.axis = -1;
  const bool a_is_box = std::holds_alternative<BoxShape>(*a.shape);
  const bool b_is_plane = std::holds_alternative<PlaneShape>(*b.shape);
  if (std::holds_alternative<SphereShape>(*a.shape)) {
    find_sphere_points(a, b, margin, found);
  } else if (a_is_box && b_is_plane) {
    find_corner_points(a, b, margin, found);
  } else if (b_is_plane) {
    find_surface_points_on_plane(a, b, margin, found);
  } else if (a_is_box) {
    found.is_along_normal = true;
    find_box_points(a, b, margin, last_axis, found);
  } else {
    find_surface_points(a, b, margin, found);
  }
}

}  // namespace verisim::dem
