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
