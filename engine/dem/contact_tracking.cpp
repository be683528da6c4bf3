// SPDX-License-Identifier: MIT
#include "dem/contact_tracking.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dem/normal_law.h"
#include "dem/surface_contact.h"

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

// Closer than this share of the impact depth counts as touch-down.
constexpr double kTouchDown = 1e-3;
// A point that got a new name but moved less than this share of the smaller body is the same.
constexpr double kSamePlace = 0.01;
// An approach faster than this many times the fall through the depth of rest is an impact.
constexpr double kImpact = 3;
// Depths of rest from which a pair has the least room left, and how much that is of the most.
constexpr double kDeep = 15, kLeastRoom = 0.1;

ContactPoint point_from(const FoundPoint& found) {
  ContactPoint point;
  point.id = found.id;
  point.place = found.place;
  point.normal = found.normal;
  point.depth = found.depth;
  point.weight = found.weight;
  return point;
}

/// Takes over the spring of `old`. Where the depth is measured along another axis now, the spring
/// keeps its compression, or the change of axis would load it.
void inherit(const ContactPoint& old, bool same_axis, ContactPoint& point) {
  const double compression = std::max(0.0, old.depth - old.offset);
  point.offset = same_axis ? old.offset : std::max(0.0, point.depth - compression);
  point.stretch_b = old.stretch_b;
  point.rolled_b = old.rolled_b;
  point.shear = old.shear;
  point.load = old.load;
  point.expected = old.expected;
  point.is_touching = old.is_touching;
  point.has_slid = old.has_slid;
  point.anchor = old.anchor;
}

/// The old load over new points that are none of the old: equal forces, their energy no more than
/// the old one.
void share_load(const std::vector<ContactPoint>& old, ContactPair& pair) {
  double load = 0, energy = 0;
  for (const ContactPoint& point : old) {
    const double force = pair.stiffness * point.weight * std::max(0.0, point.depth - point.offset);
    load += force;
    energy += normal_energy(pair, point);
  }
  double compliance = 0, count = 0;
  for (const ContactPoint& point : pair.points) {
    if (point.depth <= 0) continue;
    ++count;
    compliance += 1 / (pair.stiffness * point.weight);
  }
  if (load <= 0 || count == 0) return;
  double share = load / count;
  const double new_energy = 0.5 * share * share * compliance;
  if (new_energy > energy) share *= std::sqrt(energy / new_energy);
  for (ContactPoint& point : pair.points) {
    if (point.depth <= 0) continue;
    point.offset = point.depth - share / (pair.stiffness * point.weight);
    point.load = share;
    point.is_touching = true;
  }
}

/// Returns the energy (J) of springs that nobody took over.
double keep_springs(const std::vector<ContactPoint>& old, double same_place, bool same_axis,
                    ContactPair& pair) {
  bool knows_any = false;
  std::vector<const ContactPoint*> unclaimed;
  const auto known = [&](std::uint64_t id) {
    return std::find_if(old.begin(), old.end(),
                        [&](const ContactPoint& point) { return point.id == id; });
  };
  for (const ContactPoint& point : old) {
    const bool is_found = std::any_of(pair.points.begin(), pair.points.end(),
                                      [&](const ContactPoint& p) { return p.id == point.id; });
    if (!is_found) unclaimed.push_back(&point);
  }
  for (ContactPoint& point : pair.points) {
    if (const auto it = known(point.id); it != old.end()) {
      inherit(*it, true, point);
      knows_any = true;
      continue;
    }
    const auto near = std::find_if(unclaimed.begin(), unclaimed.end(), [&](const ContactPoint* p) {
      return (p->place - point.place).norm() < same_place;
    });
    if (near != unclaimed.end()) {
      inherit(**near, same_axis, point);
      unclaimed.erase(near);
      knows_any = true;
    } else if (pair.is_touching) {
      point.offset = std::max(0.0, point.depth);
    }
  }
  double lost = 0;
  for (const ContactPoint* point : unclaimed) lost += normal_energy(pair, *point);
  if (!knows_any && pair.is_touching) {
    share_load(old, pair);
    for (const ContactPoint& point : pair.points) lost -= normal_energy(pair, point);
  }
  return lost;
}

/// Old and new points in the same order with the same names: the usual case.
bool are_same(const std::vector<ContactPoint>& points, const std::vector<FoundPoint>& found) {
  if (points.size() != found.size()) return false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].id != found[i].id) return false;
  }
  return true;
}

}  // namespace

double look_at(LocalPair& local, const std::vector<BodyState>& bodies, double margin,
               double elapsed) {
  thread_local Found found;
  thread_local std::vector<ContactPoint> old;
  ContactPair& pair = local.pair;
  const BodyState& a = bodies[static_cast<std::size_t>(local.a)];
  const BodyState& b = bodies[static_cast<std::size_t>(local.b)];
  find_points(a, b, margin, pair.last_axis, found);
  pair.gap = found.gap;
  pair.look_margin = margin;
  pair.gap_normal = found.normal;
  pair.gap_is_along_normal = found.is_along_normal;
  const bool same_axis = pair.last_axis == found.axis;
  pair.last_axis = found.axis;
  if (are_same(pair.points, found.points)) {
    for (std::size_t i = 0; i < found.points.size(); ++i) {
      ContactPoint& point = pair.points[i];
      point.place = found.points[i].place;
      point.normal = found.points[i].normal;
      point.depth = found.points[i].depth;
    }
    return 0;
  }
  old.swap(pair.points);
  pair.points.clear();
  for (const FoundPoint& point : found.points) pair.points.push_back(point_from(point));
  if (old.empty()) return 0;
  for (ContactPoint& point : old) point.depth += elapsed * closing_speed(local, bodies, point);
  const double same_place = kSamePlace * std::min(a.size, b.size > 0 ? b.size : a.size);
  return keep_springs(old, same_place, same_axis, pair);
}

void look_and_book(LocalPair& local, Island& island, double margin, double elapsed) {
  island.books.damping_work += look_at(local, island.bodies, margin, elapsed);
}

double closing_speed(const LocalPair& local, const std::vector<BodyState>& bodies,
                     const ContactPoint& point) {
  const BodyState& a = bodies[static_cast<std::size_t>(local.a)];
  const BodyState& b = bodies[static_cast<std::size_t>(local.b)];
  return -point.normal.dot(a.velocity_at(point.place) - b.velocity_at(point.place));
}

double touch_gap(const ContactSettings& settings) { return kTouchDown * settings.impact_depth; }

double fastest_closing(const LocalPair& local, const std::vector<BodyState>& bodies,
                       const ContactSettings& settings) {
  double fastest = -std::numeric_limits<double>::infinity();
  for (const ContactPoint& point : local.pair.points) {
    if (point.depth < -touch_gap(settings)) continue;
    fastest = std::max(fastest, closing_speed(local, bodies, point));
  }
  return fastest;
}

bool has_contact(const Island& island) {
  return std::any_of(island.pairs.begin(), island.pairs.end(),
                     [](const LocalPair& local) { return local.pair.is_touching; });
}

double normal_energy(const ContactPair& pair, const ContactPoint& point) {
  const double compression = std::max(0.0, point.depth - point.offset);
  return 0.5 * pair.stiffness * point.weight * compression * compression;
}

void record_event(Island& island, const LocalPair& local, ContactChange change, double speed) {
  const ContactPair& pair = local.pair;
  ContactEvent event;
  event.change = change;
  event.time = island.time;
  event.body_a = pair.a;
  event.body_b = pair.b;
  event.speed = speed;
  const auto nearest = std::max_element(
      pair.points.begin(), pair.points.end(),
      [](const ContactPoint& p, const ContactPoint& q) { return p.depth < q.depth; });
  if (nearest != pair.points.end()) {
    const BodyState& a = island.bodies[static_cast<std::size_t>(local.a)];
    const BodyState& b = island.bodies[static_cast<std::size_t>(local.b)];
    const Vector3d velocity = a.velocity_at(nearest->place) - b.velocity_at(nearest->place);
    event.sliding_speed = (velocity - nearest->normal.dot(velocity) * nearest->normal).norm();
  }
  island.books.events.push_back(event);
}

Vector3d turned_into_plane(Vector3d stretch, const Vector3d& normal) {
  const double length = stretch.norm();
  stretch -= normal.dot(stretch) * normal;
  const double left = stretch.norm();
  if (left > 0) stretch *= length / left;
  return stretch;
}

double inverse_pair_mass(const BodyState& a, const BodyState& b) {
  return a.inverse_mass + b.inverse_mass;
}

double deepest(const ContactPair& pair) {
  double depth = 0;
  for (const ContactPoint& point : pair.points) depth = std::max(depth, point.depth);
  return depth;
}

double room(double depth, double share, const ContactSettings& settings) {
  const double left = 1 - depth / (kDeep * settings.rest_depth);
  return share * settings.rest_depth * std::max(kLeastRoom, left);
}

double least_approach_speed(const ContactSettings& settings) {
  return std::sqrt(settings.gravity.norm() * settings.rest_depth);
}

double least_impact_speed(const ContactSettings& settings) {
  return kImpact * least_approach_speed(settings);
}

double stiffen(ContactPair& pair, double stiffness) {
  const double old = pair.stiffness;
  if (!(stiffness > old)) return 0;
  double loss = 0;
  for (ContactPoint& point : pair.points) {
    // The tangential spring keeps its force as well: it shortens. That counts as slip.
    point.stretch_b *= old / stiffness;
    const double compression = point.depth - point.offset;
    if (compression <= 0) continue;
    loss += 0.5 * old * point.weight * compression * compression * (1 - old / stiffness);
    point.offset = point.depth - compression * old / stiffness;
  }
  pair.stiffness = stiffness;
  return loss;
}

void update_contact(LocalPair& local, Island& island, const ContactSettings& settings,
                    double tolerance) {
  ContactPair& pair = local.pair;
  const BodyState& a = island.bodies[static_cast<std::size_t>(local.a)];
  const BodyState& b = island.bodies[static_cast<std::size_t>(local.b)];
  double fastest = -std::numeric_limits<double>::infinity(), parting = 0, deepest = -tolerance;
  double nearest = -std::numeric_limits<double>::infinity();
  bool is_near = false;
  for (const ContactPoint& point : pair.points) {
    const double speed = closing_speed(local, island.bodies, point);
    if (point.depth > nearest) {
      nearest = point.depth;
      parting = -speed;
    }
    if (point.depth < -tolerance) continue;
    is_near = true;
    fastest = std::max(fastest, speed);
    deepest = std::max(deepest, point.depth);
  }
  if (!pair.is_touching && is_near && (fastest >= 0 || deepest > 0)) {
    fastest = std::max(fastest, 0.0);
    const double mass = 1 / inverse_pair_mass(a, b);
    const double ratio = fastest / settings.impact_depth;
    const double weight = mass * settings.gravity.norm();
    pair.is_touching = true;
    pair.is_compressing = true;
    pair.approach_speed = std::max(fastest, least_approach_speed(settings));
    pair.stiffness = settings.stiffness > 0
                         ? settings.stiffness
                         : std::max({mass * ratio * ratio, weight / settings.rest_depth,
                                     1e-9 * mass / (settings.rest_depth * settings.rest_depth)});
    if (settings.contact_law == NormalLaw::kHertzMindlin) {
      const double least = 1e-9 * mass / (settings.rest_depth * settings.rest_depth);
      pair.stiffness =
          std::max(least, hertz_step_stiffness(pair.law, mass, pair.approach_speed, deepest));
    }
    pair.mean_load = 0;
    // What begins under the surface (a scene that starts so) is held there, not thrown out.
    for (ContactPoint& point : pair.points) {
      point.offset = point.depth > tolerance ? point.depth : 0;
    }
    record_event(island, local, ContactChange::kBegin, fastest);
  } else if (pair.is_touching && deepest <= 0 && (!is_near || fastest < 0)) {
    pair.is_touching = false;
    for (ContactPoint& point : pair.points) {
      point.offset = 0;
      point.stretch_b.setZero();
      point.rolled_b.setZero();
      point.shear = 0;
      point.load = 0;
      point.is_touching = false;
    }
    record_event(island, local, ContactChange::kEnd, parting);
  }
}

}  // namespace verisim::dem
