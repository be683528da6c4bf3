// SPDX-License-Identifier: MIT
#include "dem/surface_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "dem/anchor_creep.h"
#include "dem/contact_tracking.h"
#include "dem/explicit_step.h"
#include "dem/normal_law.h"
#include "dem/prescribed.h"
#include "dem/restitution.h"
#include "dem/surface_contact.h"
#include "dem/tether_definition.h"
#include "dem/xpbd.h"

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

// Allowed penetration where a scene names none: a share of the smallest free body, below what a
// pixel shows.
constexpr double kMaxPenetration = 1e-3;
// Of the allowed penetration: depth under a resting load; what is left is for impacts on it.
constexpr double kRestShare = 0.05;
// Of the allowed penetration: depth of an impact. The fewer bodies an island has the less a
// stiffer impact costs, and the less gravity acts during it.
constexpr double kLeastImpactShare = 0.05, kMostImpactShare = 0.5, kImpactSharePerBody = 0.025;
// Of frames; see advance_islands.
constexpr int kMostRetakes = 20;
// Steps that a throng may next take within the bounds of its bodies.
constexpr double kStepsPerPiece = 2;
constexpr double kOnTime = 1e-12;  // of a frame

std::size_t at(int i) { return static_cast<std::size_t>(i); }

double reach_of(const CollisionShape& shape) {
  if (const auto* sphere = std::get_if<SphereShape>(&shape)) return sphere->radius;
  if (const auto* box = std::get_if<BoxShape>(&shape)) return box->half.norm();
  if (const auto* mesh = std::get_if<MeshShape>(&shape)) return mesh->surface->reach;
  return 0;
}

long num_samples_of(const CollisionShape& shape) {
  if (const auto* box = std::get_if<BoxShape>(&shape)) {
    return box->surface ? static_cast<long>(box->surface->points.size()) : 8;
  }
  if (const auto* mesh = std::get_if<MeshShape>(&shape)) {
    return static_cast<long>(mesh->surface->points.size());
  }
  return std::holds_alternative<SphereShape>(shape) ? 1 : 0;
}

/// Half extents of a body along the world's axes (m).
Vector3d extents_of(const BodyState& body) {
  if (const auto* box = std::get_if<BoxShape>(body.shape)) {
    return body.rotation.cwiseAbs() * box->half;
  }
  return Vector3d::Constant(body.reach);
}

BodyState plane_state(const PlaneDefinition& plane, const CollisionShape& shape, int index) {
  BodyState state;
  state.motion = Motion::kFixed;
  state.shape = &shape;
  state.index = index;
  state.position = plane.offset * plane.normal;
  state.orientation = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), plane.normal);
  refresh(state);
  return state;
}

/// Implicit steps know the default laws' springs, no lines and no rolling springs.
bool may_rest(const Island& island, const ContactSettings& settings) {
  return settings.contact_law == NormalLaw::kHuntCrossley &&
         settings.tangential_law == TangentialLaw::kSpring && island.tethers.empty() &&
         std::none_of(island.pairs.begin(), island.pairs.end(),
                      [](const LocalPair& local) { return local.pair.law.rolling_friction > 0; });
}

/// The first body of the set that body i is joined to; `parents` leads there and is shortened.
int root_of(std::vector<int>& parents, int i) {
  while (parents[at(i)] != i) i = parents[at(i)] = parents[at(parents[at(i)])];
  return i;
}

void join(std::vector<int>& parents, int i, int j) {
  const int a = root_of(parents, i), b = root_of(parents, j);
  parents[at(std::max(a, b))] = std::min(a, b);
}

/// Nothing has happened in the island yet; its memory stays.
void restart(Island& island, double time) {
  std::vector<ContactEvent> events = std::move(island.books.events);
  events.clear();
  island.books = {};
  island.books.events = std::move(events);
  island.bodies.clear();
  island.tethers.clear();
  island.time = time;
  island.num_free = 0;
  island.has_forces = false;
}

}  // namespace

SurfaceContacts::SurfaceContacts(const WorldDefinition& definition)
    : materials_(definition.material_pairs) {
  const int num_bodies = static_cast<int>(definition.bodies.size());
  double smallest = std::numeric_limits<double>::infinity();
  for (const BodyDefinition& body : definition.bodies) {
    shapes_.push_back(body.shape);
    material_.push_back(body.material);
    paths_.push_back(body.prescribed);
    drag_patches_.push_back(body.drag_patches);
    num_samples_ += num_samples_of(body.shape);
    if (body.motion == Motion::kFree) smallest = std::min(smallest, body.size);
  }
  for (const PlaneDefinition& plane : definition.planes) {
    shapes_.push_back(PlaneShape{});
    material_.push_back(plane.material);
  }
  for (int b = 0; b < num_bodies; ++b) {
    const BodyDefinition& body = definition.bodies[at(b)];
    BodyState state;
    state.shape = &shapes_[at(b)];
    state.motion = body.motion;
    state.path = body.motion == Motion::kPrescribed ? &paths_[at(b)] : nullptr;
    state.drag_patches = &drag_patches_[at(b)];
    state.index = b;
    state.size = body.size;
    state.reach = reach_of(body.shape);
    state.mass = body.mass;
    state.inverse_mass = state.is_free() ? 1 / body.mass : 0;
    state.inertia_b = body.inertia_b;
    state.inverse_inertia_b = body.inertia_b.inverse();
    bodies_.push_back(state);
  }
  for (int p = 0; p < static_cast<int>(definition.planes.size()); ++p) {
    PlaneDefinition plane = definition.planes[at(p)];
    plane.normal.normalize();
    bodies_.push_back(plane_state(plane, shapes_[at(num_bodies + p)], num_bodies + p));
  }
  const DemSettings& dem = definition.dem;
  if (!std::isfinite(smallest)) smallest = 1;
  chosen_.max_penetration =
      dem.max_penetration > 0 ? dem.max_penetration : kMaxPenetration * smallest;
  chosen_.rest_depth = kRestShare * chosen_.max_penetration;
  settings_.method = definition.method;
  settings_.gravity = definition.gravity;
  settings_.rest_depth = chosen_.rest_depth;
  settings_.stiffness = dem.stiffness;
  settings_.impact_step = impact_step(dem.steps_per_contact);
  settings_.rests_implicitly = dem.rests_implicitly;
  settings_.wind = definition.wind;
  settings_.contact_law = dem.contact_law;
  settings_.tangential_law = dem.tangential_law;
  tethers_ = make_tethers(definition);
  for (const double e : materials_.restitution) {
    factor_of_law_.push_back(damping_factor(dem.contact_law, e, dem.steps_per_contact));
  }
}

void SurfaceContacts::load_bodies(const World& world) {
  const Bodies& bodies = world.bodies;
  for (int b = 0; b < bodies.count(); ++b) {
    BodyState& state = bodies_[at(b)];
    state.position = bodies.position[at(b)];
    state.orientation = bodies.orientation[at(b)];
    state.velocity = bodies.linear_velocity[at(b)];
    state.angular_momentum = bodies.angular_momentum[at(b)];
    state.spin = bodies.angular_velocity[at(b)];
    state.inverse_inertia_all_axes = bodies.inverse_inertia_all_axes[at(b)];
    state.outside_force = bodies.outside.force[at(b)];
    state.outside_torque = bodies.outside.torque[at(b)];
    refresh(state);
  }
  if (world.drag) {
    BodyState& state = bodies_[at(world.drag->body)];
    const Vector3d arm = state.rotation * world.drag->grip_b;
    const Vector3d grip = state.position + arm;
    const Vector3d force = world.drag->stiffness * (world.drag->target - grip) -
                           world.drag->damping * state.velocity_at(grip);
    state.outside_force += force;
    state.outside_torque += arm.cross(force);
  }
}

void SurfaceContacts::store_bodies(World& world) const {
  Bodies& bodies = world.bodies;
  for (int b = 0; b < bodies.count(); ++b) {
    const BodyState& state = bodies_[at(b)];
    bodies.position[at(b)] = state.position;
    bodies.orientation[at(b)] = state.orientation;
    bodies.linear_velocity[at(b)] = state.velocity;
    bodies.angular_velocity[at(b)] = state.spin;
    bodies.angular_momentum[at(b)] =
        state.is_free() ? state.angular_momentum
                        : Vector3d(state.rotation *
                                   (state.inertia_b * (state.rotation.transpose() * state.spin)));
  }
}

SurfaceContacts::Bounds SurfaceContacts::bounds_over(const BodyState& body, double duration) const {
  const double infinity = std::numeric_limits<double>::infinity();
  if (std::holds_alternative<PlaneShape>(*body.shape)) {
    return {Vector3d::Constant(-infinity), Vector3d::Constant(infinity)};
  }
  const double turn = body.spin.norm() * duration;
  const Vector3d extents = extents_of(body).cwiseMin(Vector3d::Constant(body.reach)) +
                           Vector3d::Constant(std::min(turn, 2.0) * body.reach);
  const Vector3d fall =
      body.is_free() ? Vector3d(0.5 * duration * duration * settings_.gravity) : Vector3d::Zero();
  const Vector3d end = body.position + duration * body.velocity + fall;
  // What is slower than a fall of this duration lies on something.
  const double way = duration * body.velocity.norm();
  const double margin = 0.25 * way + std::min(fall.norm(), 0.5 * way) + 2 * chosen_.max_penetration;
  const Vector3d all =
      extents.cwiseMin(Vector3d::Constant(body.reach)) + Vector3d::Constant(margin);
  return {body.position.cwiseMin(end) - all, body.position.cwiseMax(end) + all};
}

PairLaw SurfaceContacts::law_of(int a, int b) const {
  const std::size_t k = materials_.at(material_[at(a)], material_[at(b)]);
  PairLaw law;
  law.restitution = materials_.restitution[k];
  law.friction = materials_.friction[k];
  const auto* ball_a = std::get_if<SphereShape>(&shapes_[at(a)]);
  const auto* ball_b = std::get_if<SphereShape>(&shapes_[at(b)]);
  if (ball_a == nullptr && ball_b == nullptr) return law;
  law.radius = 1 / ((ball_a != nullptr ? 1 / ball_a->radius : 0) +
                    (ball_b != nullptr ? 1 / ball_b->radius : 0));
  if (!materials_.rolling_friction.empty()) law.rolling_friction = materials_.rolling_friction[k];
  if (settings_.contact_law == NormalLaw::kHertzMindlin) {
    const auto elastic = [&](int body) {
      const std::size_t material = at(material_[at(body)]);
      return Elastic{materials_.young_modulus[material], materials_.poisson_ratio[material]};
    };
    set_hertz(law, elastic(a), elastic(b));
  }
  return law;
}

/// Sets pairs_ to all pairs whose bounds overlap, known ones with their points.
void SurfaceContacts::add_pairs() {
  const int count = static_cast<int>(bodies_.size());
  std::vector<std::uint64_t>& keys = scratch_.keys;
  keys.clear();
  const auto add = [&](int i, int j) {
    const BodyState &x = bodies_[at(i)], &y = bodies_[at(j)];
    if (!x.is_free() && !y.is_free()) return;
    const bool swap =
        !is_in_order(*x.shape, *y.shape) || (is_in_order(*y.shape, *x.shape) && j < i);
    ContactPair pair;
    pair.a = swap ? j : i;
    pair.b = swap ? i : j;
    keys.push_back(pair.key());
  };
  const auto overlap = [&](int i, int j) {
    const Bounds &x = bounds_[at(i)], &y = bounds_[at(j)];
    return (x.low.array() <= y.high.array()).all() && (y.low.array() <= x.high.array()).all();
  };
  std::vector<int>& order = scratch_.order;  // of the bounded, along the axis of the widest spread
  order.clear();
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (int i = 0; i < count; ++i) {
    if (std::holds_alternative<PlaneShape>(*bodies_[at(i)].shape)) continue;
    order.push_back(i);
    low = low.cwiseMin(bodies_[at(i)].position);
    high = high.cwiseMax(bodies_[at(i)].position);
  }
  int axis = 0;
  if (!order.empty()) (high - low).maxCoeff(&axis);
  std::sort(order.begin(), order.end(), [&](int i, int j) {
    const double x = bounds_[at(i)].low[axis], y = bounds_[at(j)].low[axis];
    return x != y ? x < y : i < j;
  });
  for (std::size_t s = 0; s < order.size(); ++s) {
    for (std::size_t t = s + 1; t < order.size(); ++t) {
      if (bounds_[at(order[t])].low[axis] > bounds_[at(order[s])].high[axis]) break;
      if (overlap(order[s], order[t])) add(order[s], order[t]);
    }
  }
  for (int p = 0; p < count; ++p) {
    const BodyState& plane = bodies_[at(p)];
    if (!std::holds_alternative<PlaneShape>(*plane.shape)) continue;
    const Vector3d up = plane.rotation.col(2);
    for (const int i : order) {
      const Bounds& bounds = bounds_[at(i)];
      const Vector3d lowest = (up.array() > 0).select(bounds.low, bounds.high);
      if (up.dot(lowest - plane.position) <= 0) add(i, p);
    }
  }
  std::sort(keys.begin(), keys.end());
  const auto has_key = [](const ContactPair& pair, std::uint64_t key) { return pair.key() == key; };
  if (std::equal(pairs_.begin(), pairs_.end(), keys.begin(), keys.end(), has_key)) return;
  std::vector<ContactPair> pairs;
  pairs.reserve(keys.size());
  auto known = pairs_.begin();
  for (const std::uint64_t key : keys) {
    while (known != pairs_.end() && known->key() < key) ++known;
    if (known != pairs_.end() && known->key() == key) {
      pairs.push_back(std::move(*known));
      continue;
    }
    ContactPair pair;
    pair.a = static_cast<int>(key >> 32);
    pair.b = static_cast<int>(key & 0xffffffffu);
    pair.law = law_of(pair.a, pair.b);
    pairs.push_back(std::move(pair));
  }
  pairs_ = std::move(pairs);
}

/// What meets a body that left its bounds may go on along the same way, and so may what that meets
/// (a row of balls).
void SurfaceContacts::pass_on_pushes() {
  const auto pass = [&](int from, int to) {
    const Vector3d& push = scratch_.pushes[at(from)];
    if (push.isZero(0) || !scratch_.pushes[at(to)].isZero(0) || !bodies_[at(to)].is_free()) {
      return false;
    }
    scratch_.pushes[at(to)] = push;
    bounds_[at(to)].low += push.cwiseMin(0);
    bounds_[at(to)].high += push.cwiseMax(0);
    return true;
  };
  for (bool is_any = true; is_any;) {
    is_any = false;
    for (const ContactPair& pair : pairs_) {
      is_any = pass(pair.a, pair.b) || pass(pair.b, pair.a) || is_any;
    }
    if (is_any) add_pairs();
  }
}

/// Widens the bounds of bodies that left theirs; true if that makes a pair that was not looked at.
bool SurfaceContacts::add_missed_pairs() {
  bool has_any_left = false;
  scratch_.pushes.assign(bodies_.size(), Vector3d::Zero());
  const auto widen = [&](const BodyState& body, bool is_pushing) {
    Bounds& bounds = bounds_[at(body.index)];
    const Vector3d extents = extents_of(body).cwiseMax(extents_of(bodies_[at(body.index)]));
    const Vector3d low = body.path_low - extents, high = body.path_high + extents;
    if ((low.array() >= bounds.low.array()).all() && (high.array() <= bounds.high.array()).all()) {
      return;
    }
    const double margin = 0.1 * (high - low).norm();
    bounds.low = bounds.low.cwiseMin(low - Vector3d::Constant(margin));
    bounds.high = bounds.high.cwiseMax(high + Vector3d::Constant(margin));
    has_any_left = true;
    if (is_pushing)
      scratch_.pushes[at(body.index)] = body.position - bodies_[at(body.index)].position;
  };
  for (const Island& island : islands_) {
    for (int i = 0; i < island.num_free; ++i) widen(island.bodies[at(i)], !is_throng(island));
  }
  if (!has_any_left) return false;
  const std::size_t before = pairs_.size();
  add_pairs();
  if (pairs_.size() == before) return false;
  pass_on_pushes();
  return true;
}

/// Sets islands_ to copies of all bodies and pairs at `time` (s).
void SurfaceContacts::make_islands(double time) {
  std::vector<int>& parents = scratch_.parents;
  parents.resize(bodies_.size());
  std::iota(parents.begin(), parents.end(), 0);
  for (const ContactPair& pair : pairs_) {
    if (bodies_[at(pair.a)].is_free() && bodies_[at(pair.b)].is_free()) {
      join(parents, pair.a, pair.b);
    }
  }
  for (const Tether& tether : tethers_) {
    if (tether.b >= 0) join(parents, tether.a, tether.b);
  }
  std::vector<int>&island_of = scratch_.island_of, &local_of = scratch_.local_of;
  island_of.assign(bodies_.size(), -1);
  local_of.assign(bodies_.size(), -1);
  std::size_t num_islands = 0;
  for (const BodyState& body : bodies_) {
    if (!body.is_free()) continue;
    const int root = root_of(parents, body.index);
    if (island_of[at(root)] < 0) {
      island_of[at(root)] = static_cast<int>(num_islands);
      if (islands_.size() == num_islands) islands_.emplace_back();
      restart(islands_[num_islands++], time);
    }
    Island& island = islands_[at(island_of[at(root)])];
    island_of[at(body.index)] = island_of[at(root)];
    local_of[at(body.index)] = island.num_free++;
    island.bodies.push_back(body);
  }
  islands_.resize(num_islands);
  add_pairs_to_islands();
  for (const Tether& tether : tethers_) {
    Tether local = tether;
    local.a = local_of[at(tether.a)];
    if (tether.b >= 0) local.b = local_of[at(tether.b)];
    islands_[at(island_of[at(tether.a)])].tethers.push_back(local);
  }
}

void SurfaceContacts::add_pairs_to_islands() {
  const auto island_with = [&](const ContactPair& pair) {
    return at(scratch_.island_of[at(bodies_[at(pair.a)].is_free() ? pair.a : pair.b)]);
  };
  std::vector<std::size_t>& num_pairs = scratch_.num_pairs;
  num_pairs.assign(islands_.size(), 0);
  for (const ContactPair& pair : pairs_) ++num_pairs[island_with(pair)];
  for (std::size_t i = 0; i < islands_.size(); ++i) islands_[i].pairs.resize(num_pairs[i]);
  num_pairs.assign(islands_.size(), 0);
  for (const ContactPair& pair : pairs_) {
    const std::size_t i = island_with(pair);
    Island& island = islands_[i];
    LocalPair& local = island.pairs[num_pairs[i]++];
    local.pair = pair;
    local.moved = -1;
    const auto local_index = [&](int body) {
      if (bodies_[at(body)].is_free()) return scratch_.local_of[at(body)];
      for (int k = island.num_free; k < static_cast<int>(island.bodies.size()); ++k) {
        if (island.bodies[at(k)].index == body) return k;
      }
      island.bodies.push_back(bodies_[at(body)]);
      return static_cast<int>(island.bodies.size()) - 1;
    };
    local.a = local_index(pair.a);
    local.b = local_index(pair.b);
    local.factor = factor_of_law_[materials_.at(material_[at(pair.a)], material_[at(pair.b)])];
  }
}

void SurfaceContacts::take_parameters(const World& world) {
  settings_.gravity = world.parameters.gravity;
  settings_.stiffness = world.parameters.dem.stiffness;
}

void SurfaceContacts::advance(Island& island, double end) const {
  ContactSettings settings = settings_;
  const double share =
      std::clamp(kImpactSharePerBody * island.num_free, kLeastImpactShare, kMostImpactShare);
  settings.impact_depth = share * chosen_.max_penetration;
  if (settings.method == Method::kXpbd) return advance_xpbd(island, end, settings);
  settings.rests_implicitly = settings.rests_implicitly && may_rest(island, settings);
  advance_island(island, end, settings);
}

/// How much of `longest` (s) to look for pairs over at once: a throng that takes short steps leaves
/// bounds over a long time, and they hold pairs that it never meets.
double SurfaceContacts::piece_of(double longest) const {
  double least = longest;
  for (const BodyState& body : bodies_) least = std::min(least, kStepsPerPiece * body.next_step);
  return longest / std::ceil(longest / least - kOnTime);
}

/// Takes all islands from `start` to `end` (s) or some of the way, and returns how far. Again with
/// wider bounds, and not as far where steps turned out short, until no body left its own unseen.
double SurfaceContacts::advance_islands(World& world, double start, double end) {
  double piece = piece_of(end - start);
  const auto until = [&] { return piece < end - start ? start + piece : end; };
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    bodies_[i].path_low = bodies_[i].path_high = bodies_[i].position;
    bounds_[i] = bounds_over(bodies_[i], piece);
  }
  add_pairs();
  for (int take = 0; take < kMostRetakes; ++take) {
    make_islands(start);
    world.pool->run_ranges(static_cast<int>(islands_.size()), 1, [&](int begin, int last) {
      for (int i = begin; i < last; ++i) advance(islands_[at(i)], until());
    });
    if (!add_missed_pairs()) break;
    for (const Island& island : islands_) {
      for (int i = 0; i < island.num_free; ++i) {
        bodies_[at(island.bodies[at(i)].index)].next_step = island.bodies[at(i)].next_step;
      }
    }
    piece = std::min(piece, piece_of(end - start));
  }
  return until();
}

/// Takes bodies, pairs and tethers back from the islands; pairs in order of their keys.
void SurfaceContacts::take_back(double time) {
  std::size_t num_pairs = 0;
  for (const Island& island : islands_) num_pairs += island.pairs.size();
  pairs_.resize(num_pairs);
  auto next = pairs_.begin();
  for (Island& island : islands_) {
    for (int i = 0; i < island.num_free; ++i) {
      bodies_[at(island.bodies[at(i)].index)] = island.bodies[at(i)];
    }
    // Swapped, so that either side keeps memory for points.
    for (LocalPair& local : island.pairs) std::swap(*next++, local.pair);
    for (const Tether& tether : island.tethers) {
      tethers_[at(tether.index)].tension = tether.tension;
      tethers_[at(tether.index)].is_taut = tether.is_taut;
    }
  }
  std::sort(pairs_.begin(), pairs_.end(),
            [](const ContactPair& x, const ContactPair& y) { return x.key() < y.key(); });
  for (BodyState& body : bodies_) {
    if (body.path != nullptr) follow_path(body, time);
  }
  for (ContactPair& pair : pairs_) {
    const double creep = follow_anchors(pair, bodies_[at(pair.a)], bodies_[at(pair.b)]);
    anchor_creep_ = std::max(anchor_creep_, creep);
  }
}

/// Adds what the islands did to the books of the run and of the step.
void SurfaceContacts::book_islands(Balance& balance, StepReport& report) {
  long num_contacts = 0;
  elastic_energy_ = 0;
  for (const Island& island : islands_) {
    const IslandBooks& books = island.books;
    balance.damping_work += books.damping_work;
    balance.friction_work += books.friction_work;
    balance.outside_work += books.outside_work;
    balance.impulse += books.impulse;
    balance.angular_impulse += books.angular_impulse;
    balance.impulse_size += books.impulse_size;
    balance.angular_impulse_size += books.angular_impulse_size;
    balance.overlap_total += books.overlap_total;
    balance.squared_overlap_total += books.squared_overlap_total;
    balance.contacts_total += books.num_overlaps;
    balance.max_overlap = std::max(balance.max_overlap, books.max_overlap);
    elastic_energy_ += books.elastic_energy;
    implicit_work_ += books.implicit_work;
    correction_work_ += books.correction_work;
    energy_rise_ = std::max(energy_rise_, books.energy_rise);
    work_.num_steps += books.num_steps;
    work_.num_implicit_steps += books.num_rest_steps;
    work_.num_refused_steps += books.num_refused_steps;
    work_.num_newton_steps += books.num_newton_steps;
    if (books.num_steps > 0 && (least_step_ <= 0 || books.least_step < least_step_)) {
      least_step_ = books.least_step;
    }
    num_contacts += books.max_contacts;
    report.max_overlap = std::max(report.max_overlap, books.max_overlap);
    if (!books.is_finite && report.nonfinite_body < 0) report.nonfinite_body = books.culprit;
  }
  report.num_contacts = std::max(report.num_contacts, num_contacts);
  balance.max_contacts = std::max(balance.max_contacts, num_contacts);
  report.too_deep = report.max_overlap > 0;
}

/// Adds the islands' contact events to `events` as the world names them: bodies in order, planes
/// apart; all by time.
void SurfaceContacts::take_events(std::vector<ContactEvent>& events) const {
  const int num_bodies = static_cast<int>(paths_.size());
  for (const Island& island : islands_) {
    for (ContactEvent event : island.books.events) {
      if (event.body_b >= num_bodies) {
        event.plane = event.body_b - num_bodies;
        event.body_b = -1;
      } else if (event.body_a > event.body_b) {
        std::swap(event.body_a, event.body_b);
      }
      events.push_back(event);
    }
  }
  std::sort(events.begin(), events.end(), [](const ContactEvent& x, const ContactEvent& y) {
    return std::tuple(x.time, x.body_a, x.body_b, x.plane, x.change) <
           std::tuple(y.time, y.body_a, y.body_b, y.plane, y.change);
  });
}

StepReport SurfaceContacts::step(World& world) {
  const double duration = world.parameters.dt, end = world.time + duration;
  settings_.substep = duration / world.parameters.xpbd.substeps;
  settings_.restitution_threshold = 2 * settings_.gravity.norm() * settings_.substep;
  load_bodies(world);
  bounds_.resize(bodies_.size());
  world.contacts.events.clear();
  StepReport report;
  for (double time = world.time; time < end && report.nonfinite_body < 0;) {
    time = advance_islands(world, time, end);
    book_islands(world.balance, report);
    take_events(world.contacts.events);
    take_back(time);
  }
  world.halted = report.nonfinite_body >= 0;
  if (world.halted) return report;
  store_bodies(world);
  world.time = end;
  ++world.steps;
  book_surfaces(world);
  const Balance& balance = world.balance;
  report.energy_gain = balance.energy() - balance.energy_start - balance.outside_work;
  return report;
}

StepReport step_surfaces(World& world) { return world.surfaces->step(world); }

void book_surfaces(World& world) {
  BodySums now;
  audit(world.bodies, 0, world.bodies.count(), now);
  world.balance.contacts.elastic_energy = world.surfaces->elastic_energy();
  book_state(world.balance, now, world.parameters.gravity);
}

}  // namespace verisim::dem
