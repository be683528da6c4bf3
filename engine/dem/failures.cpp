// SPDX-License-Identifier: MIT
// Watches a run and says when it stops being right.
#include "dem/failures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dem/message_text.h"
#include "dem/surface_contacts.h"

namespace verisim::dem {
namespace {

constexpr double kEnergyGain = 0.05;  // of the energy scale
constexpr double kExplosion = 1000;   // energy scales, from where a run is not worth going on
constexpr double kTilt = 0.1;         // rad
// Of a body's size. Particles of two lattices settle into each other by up to 0.29 diameters, so a
// stack that holds (n k d = 10 W, three cubes of 4 particles) is 11 % lower at its top.
constexpr double kSink = 0.15;
constexpr double kAside = 0.1;         // of a body's size, from its place
constexpr double kDriftPer10s = 0.01;  // of a body's size, in the second half of the run
constexpr double kJitter = 0.1;        // of sqrt(g * mean overlap), rms speed in the second half

/// A gain of energy that lifts the whole world by less than this share of a particle diameter (of
/// `dem`: of the smallest free body) is not seen by anyone; it keeps rounding in a world at rest
/// from counting as a gain.
constexpr double kUnseenLift = 1e-3;

/// Diameter of the smallest particle, or size of the smallest free body (m).
double least_diameter(const World& world) {
  const Bodies& bodies = world.bodies;
  double least = std::numeric_limits<double>::infinity();
  for (int b = 0; b < bodies.count(); ++b) {
    if (bodies.num_particles(b) > 0) least = std::min(least, 2 * bodies.particle_radius[b]);
    if (world.surfaces && bodies.motion[b] == Motion::kFree) {
      least = std::min(least, bodies.size[b]);
    }
  }
  return std::isfinite(least) ? least : 0;
}

bool can_touch(const World& world, int body) {
  if (world.surfaces) return !std::holds_alternative<PlaneShape>(world.surfaces->shape(body));
  return world.bodies.num_particles(body) > 0;
}

}  // namespace

FailureWatch::FailureWatch(const World& world, const std::vector<Expectation>& expect,
                           double duration)
    : half_time_(world.time + duration / 2) {
  const Bodies& bodies = world.bodies;
  const double g = world.parameters.gravity.norm();
  up_ = g > 0 ? Eigen::Vector3d(-world.parameters.gravity / g) : Eigen::Vector3d::UnitZ();
  for (int b = 0; b < bodies.count(); ++b) {
    if (bodies.motion[b] == Motion::kFree) weight_ += bodies.mass[b] * g;
    for (const PlaneDefinition& plane : world.planes) {
      starts_above_.push_back(plane.normal.dot(bodies.position[b]) >= plane.offset);
    }
  }
  least_energy_scale_ = weight_ * kUnseenLift * least_diameter(world);
  for (const Expectation& expectation : expect) {
    for (const int b : expectation.stands) {
      standing_.push_back({b, bodies.position[b], bodies.orientation[b], bodies.position[b]});
    }
  }
  if (world.surfaces) start_surfaces(world);
}

bool FailureWatch::has_failed(const std::string& code) const {
  return std::any_of(failures_.begin(), failures_.end(),
                     [&](const Failure& failure) { return failure.code == code; });
}

void FailureWatch::fail(const World& world, const char* code, int body, double time,
                        const std::string& message) {
  if (has_failed(code)) return;
  failures_.push_back({code, body >= 0 ? world.names[body] : "", world.steps, time, message});
}

bool FailureWatch::observe(const World& world, const StepReport& report) {
  if (world.halted) {
    const int b = std::max(report.nonfinite_body, 0);
    fail(world, "nonfinite", b, world.time,
         text("the force on ", world.names[b], " is not finite; the run stops here"));
    return false;
  }
  if (world.surfaces) {
    note_deep_surfaces(world, report);
    check_centres(world);
  } else {
    if (report.too_deep) note_deep_pairs(world);
    check_leaps(world);  // `dem` steps to each touch-down
  }
  check_planes(world);
  check_flips(world);
  follow_standing(world);
  return check_energy(world, report);
}

bool FailureWatch::check_energy(const World& world, const StepReport& report) {
  const double scale = std::max(world.balance.energy_scale(), least_energy_scale_);
  if (!(report.energy_gain > kEnergyGain * scale)) return true;
  if (!has_failed("energy_gain")) {
    // The scale grows with the explosion itself, so the one at its beginning is the measure.
    explosion_energy_ = kExplosion * scale;
    fail(world, "energy_gain", -1, world.time,
         text("energy rose by ", report.energy_gain, " J that nothing put in, more than 5 % of ",
              scale, " J"));
  }
  return report.energy_gain < explosion_energy_;
}

/// Finds who is too deep in what. Rare, so it may search all pairs.
void FailureWatch::note_deep_pairs(const World& world) {
  const Bodies& bodies = world.bodies;
  const Neighbours& lists = world.neighbours;
  const ParticleRows& rows = world.rows;
  for (const ParticlePair& pair : lists.pairs) {
    if (!pair.touches) continue;
    const RowMotion& i = rows.motion[pair.i];
    const RowMotion& j = rows.motion[pair.j];
    const double overlap = i.radius() + j.radius() - (i.place.vector() - j.place.vector()).norm();
    if (overlap <= std::min(i.radius(), j.radius())) continue;
    const int a = std::min(rows.body[pair.i], rows.body[pair.j]);
    const int b = std::max(rows.body[pair.i], rows.body[pair.j]);
    fail(world, "penetration", a, world.time,
         text("particles of ", world.names[a], " and ", world.names[b], " overlap by ", overlap,
              " m, more than half a diameter"));
    remember_deep(bodies, a, b);
  }
  for (const PlanePair& pair : lists.plane_pairs) {
    const RowMotion& i = rows.motion[pair.row];
    const PlaneDefinition& plane = world.planes[pair.plane];
    const double overlap = i.radius() + plane.offset - plane.normal.dot(i.place.vector());
    if (overlap <= i.radius()) continue;
    const int b = rows.body[pair.row];
    fail(world, "penetration", b, world.time,
         text("a particle of ", world.names[b], " is ", overlap, " m deep in ", plane.name,
              ", more than half its diameter"));
  }
}

void FailureWatch::remember_deep(const Bodies& bodies, int a, int b) {
  const auto key_a = static_cast<std::uint32_t>(a), key_b = static_cast<std::uint32_t>(b);
  if (deep_.find(key_a, key_b) != nullptr) return;
  deep_.at(key_a, key_b) = static_cast<int>(apart_when_deep_.size());
  apart_when_deep_.push_back(bodies.position[a] - bodies.position[b]);
}

void FailureWatch::check_planes(const World& world) {
  if (has_failed("pass_through")) return;
  const Bodies& bodies = world.bodies;
  const std::size_t num_planes = world.planes.size();
  for (int b = 0; b < bodies.count(); ++b) {
    if (bodies.motion[b] != Motion::kFree || !can_touch(world, b)) continue;
    for (std::size_t p = 0; p < num_planes; ++p) {
      const PlaneDefinition& plane = world.planes[p];
      if (!starts_above_[static_cast<std::size_t>(b) * num_planes + p]) continue;
      if (plane.normal.dot(bodies.position[b]) >= plane.offset) continue;
      fail(world, "pass_through", b, world.time,
           text("the centre of ", world.names[b], " crossed ", plane.name));
      return;
    }
  }
}

/// Two bodies that were too deep in each other and part on opposite sides passed through.
void FailureWatch::check_flips(const World& world) {
  if (deep_.size() == 0) return;
  const Bodies& bodies = world.bodies;
  for (const ContactEvent& event : world.contacts.events) {
    if (event.change != ContactChange::kEnd || event.body_b < 0) continue;
    const auto a = static_cast<std::uint32_t>(event.body_a);
    const auto b = static_cast<std::uint32_t>(event.body_b);
    const int* which = deep_.find(a, b);
    if (which == nullptr) continue;
    const Eigen::Vector3d apart = bodies.position[event.body_a] - bodies.position[event.body_b];
    const bool has_flipped = apart.dot(apart_when_deep_[static_cast<std::size_t>(*which)]) < 0;
    deep_.erase(a, b);
    if (!has_flipped) continue;
    fail(world, "pass_through", event.body_a, world.time,
         text(world.names[event.body_a], " went through ", world.names[event.body_b]));
  }
}

/// A body that moves more than half its size in a step may pass another without ever touching it.
void FailureWatch::check_leaps(const World& world) {
  if (has_failed("pass_through")) return;
  const Bodies& bodies = world.bodies;
  const double dt = world.parameters.dt;
  for (int a = 0; a < bodies.count(); ++a) {
    const double limit = 0.5 * bodies.size[a];
    if (bodies.num_particles(a) == 0 || bodies.motion[a] == Motion::kFixed) continue;
    if (dt * dt * bodies.linear_velocity[a].squaredNorm() <= limit * limit) continue;
    for (int b = 0; b < bodies.count(); ++b) {
      const bool may_touch =
          a != b && bodies.num_particles(b) > 0 &&
          (bodies.motion[a] == Motion::kFree || bodies.motion[b] == Motion::kFree);
      if (!may_touch) continue;
      const Eigen::Vector3d end = bodies.position[a] - bodies.position[b];
      const Eigen::Vector3d way = dt * (bodies.linear_velocity[a] - bodies.linear_velocity[b]);
      const Eigen::Vector3d start = end - way;
      const double gap = (start - start.dot(way) / way.squaredNorm() * way).norm();
      if (start.dot(way) >= 0 || end.dot(way) <= 0 ||
          gap > 0.25 * (bodies.size[a] + bodies.size[b]))
        continue;
      fail(world, "pass_through", a, world.time,
           text(world.names[a], " leapt through ", world.names[b], " in one step of ", dt, " s"));
      return;
    }
  }
}

void FailureWatch::follow_standing(const World& world) {
  const Bodies& bodies = world.bodies;
  const bool is_second_half = world.time > half_time_;
  if (is_second_half) ++half_steps_;
  const auto note = [&](double& since, bool is_outside) {
    if (!is_outside) since = -1;
    if (is_outside && since < 0) since = world.time;
  };
  for (Standing& standing : standing_) {
    const int b = standing.body;
    const Eigen::Vector3d way = bodies.position[b] - standing.start;
    const double rise = way.dot(up_);
    const Eigen::Vector3d upright =
        bodies.orientation[b] * (standing.start_orientation.conjugate() * up_);
    note(standing.toppled_since, upright.dot(up_) < std::cos(kTilt));
    note(standing.sank_since, -rise > kSink * bodies.size[b]);
    note(standing.moved_since, (way - rise * up_).norm() > kAside * bodies.size[b]);
    if (is_second_half) {
      standing.speed_squared += bodies.linear_velocity[b].squaredNorm();
    } else {
      standing.middle = bodies.position[b];
    }
  }
  if (!is_second_half) {
    overlap_before_half_ = world.balance.overlap_total;
    contacts_before_half_ = world.balance.contacts_total;
  }
}

void FailureWatch::finish(const World& world) {
  const Bodies& bodies = world.bodies;
  const double num_contacts = world.balance.contacts_total - contacts_before_half_;
  const double overlap = world.balance.overlap_total - overlap_before_half_;
  const double mean_overlap = num_contacts > 0 ? overlap / num_contacts : 0;
  const double g = world.parameters.gravity.norm();
  for (const Standing& standing : standing_) {
    const int b = standing.body;
    const std::string& name = world.names[b];
    const double size = bodies.size[b];
    const Eigen::Vector3d way = bodies.position[b] - standing.start;
    const Eigen::Vector3d late_way = bodies.position[b] - standing.middle;
    const double late_time = world.time - half_time_;
    const double drift = (late_way - late_way.dot(up_) * up_).norm();
    const double speed =
        half_steps_ > 0 ? std::sqrt(standing.speed_squared / static_cast<double>(half_steps_)) : 0;
    if (standing.toppled_since >= 0) {
      fail(world, "toppled", b, standing.toppled_since, text(name, " tilts by more than 0.1 rad"));
    }
    if (standing.sank_since >= 0) {
      fail(world, "sank", b, standing.sank_since,
           text(name, " sank by ", -way.dot(up_), " m, more than 15 % of its size"));
    }
    if (standing.moved_since >= 0) {
      fail(world, "drifted", b, standing.moved_since,
           text(name, " left its place by ", (way - way.dot(up_) * up_).norm(), " m"));
    }
    if (late_time > 0 && drift / late_time > kDriftPer10s * size / 10) {
      fail(world, "drifted", b, world.time,
           text(name, " creeps aside at ", drift / late_time, " m/s"));
    }
    if (mean_overlap > 0 && speed > kJitter * std::sqrt(g * mean_overlap)) {
      fail(world, "jitters", b, world.time,
           text(name, " does not come to rest: rms ", speed, " m/s"));
    }
  }
}

}  // namespace verisim::dem
