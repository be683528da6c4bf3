// SPDX-License-Identifier: MIT
#include "dem/explicit_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dem/contact_tracking.h"
#include "dem/flight.h"
#include "dem/tangential_law.h"
#include "dem/tethers.h"
#include "dem/wind.h"

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

// Longest time over which a pair's load is averaged (s).
constexpr double kLoadMemory = 0.02;
// A pair whose springs hold less than this share of an impact's energy counts as not pressed in.
constexpr double kUnpressed = 1e-7;

// Inverse mass of a body at a point of its surface over that at its centre, of any solid shape.
constexpr double kMostLever = 8;

/// Inverse of the mass (1/kg) that two bodies present to each other at a point, along its normal.
double inverse_mass_at(const ContactPoint& point, const BodyState& a, const BodyState& b) {
  const auto of = [&](const BodyState& body) {
    if (!body.is_free()) return 0.0;
    const Vector3d arm = (point.place - body.position).cross(point.normal);
    return body.inverse_mass + arm.dot(body.inverse_inertia * arm);
  };
  return of(a) + of(b);
}

BodyState& body_a(Island& island, const LocalPair& local) {
  return island.bodies[static_cast<std::size_t>(local.a)];
}
BodyState& body_b(Island& island, const LocalPair& local) {
  return island.bodies[static_cast<std::size_t>(local.b)];
}

/// Earliest time (s), at most `step`, at which a pair, or another point of a pair that touches, can
/// touch down.
double time_to_meet(const LocalPair& local, const Island& island, double step,
                    const ContactSettings& settings) {
  const ContactPair& pair = local.pair;
  const double touch_down = touch_gap(settings);
  if (!pair.is_touching) {
    if (pair.gap > touch_down && has_corners(local, island)) {
      return time_to_land(local, island, settings.gravity, step);
    }
    const Approach approach = approach_of(local, island, settings.gravity);
    if (pair.gap > touch_down) return close_within(step, pair.gap, approach);
    // So close and yet no landing: edges pass each other. Small steps.
    const double speed =
        std::abs(approach.speed) + std::sqrt(2 * settings.gravity.norm() * settings.impact_depth);
    return speed > 0 ? std::min(step, 0.25 * settings.impact_depth / speed) : step;
  }
  const Approach fastest = fastest_approach(local, island, settings.gravity);
  double time = close_within(step, pair.look_margin, fastest);
  for (const ContactPoint& point : pair.points) {
    if (point.depth >= -touch_down) continue;
    const Approach approach{closing_speed(local, island.bodies, point), fastest.acceleration};
    time = close_within(time, -point.depth, approach);
  }
  return time;
}

/// Sum over the points of a body of what makes it swing: an upper bound of its frequency squared.
void add_stiffness(const LocalPair& local, const Island& island, double reach_of_step,
                   std::vector<double>& rates) {
  const BodyState& a = island.bodies[static_cast<std::size_t>(local.a)];
  const BodyState& b = island.bodies[static_cast<std::size_t>(local.b)];
  for (const ContactPoint& point : local.pair.points) {
    if (point.depth < -reach_of_step) continue;
    const double k = local.pair.stiffness * point.weight;
    const auto rate = [&](const BodyState& body) {
      if (!body.is_free()) return 0.0;
      const Vector3d arm = (point.place - body.position).cross(point.normal);
      return k * (body.inverse_mass + arm.dot(body.inverse_inertia * arm));
    };
    rates[static_cast<std::size_t>(local.a)] += rate(a);
    rates[static_cast<std::size_t>(local.b)] += rate(b);
  }
}

double contact_step(const Island& island, const ContactSettings& settings) {
  thread_local std::vector<double> rates;
  rates.assign(island.bodies.size(), 0);
  for (const LocalPair& local : island.pairs) {
    if (local.pair.is_touching) add_stiffness(local, island, settings.impact_depth, rates);
  }
  double fastest = 0;
  for (const LocalPair& local : island.pairs) {
    if (!local.pair.is_touching) continue;
    fastest = std::max(fastest, rates[static_cast<std::size_t>(local.a)] +
                                    rates[static_cast<std::size_t>(local.b)]);
  }
  if (fastest <= 0) return std::numeric_limits<double>::infinity();
  return settings.impact_step / std::sqrt(fastest);
}

void kick(Island& island, double duration) {
  IslandBooks& books = island.books;
  for (std::size_t i = static_cast<std::size_t>(island.num_free); i < island.bodies.size(); ++i) {
    // What holds a body or moves it along its path gives the island what its contacts take.
    const BodyState& body = island.bodies[i];
    if (!body.is_touched) continue;
    books.impulse -= duration * body.force;
    books.angular_impulse -= duration * (body.position.cross(body.force) + body.torque);
    books.damping_work -=
        duration * (body.damping_force.dot(body.velocity) + body.damping_torque.dot(body.spin));
    books.friction_work -=
        duration * (body.friction_force.dot(body.velocity) + body.friction_torque.dot(body.spin));
    books.outside_work -= duration * (body.force.dot(body.velocity) + body.torque.dot(body.spin));
  }
  for (int i = 0; i < island.num_free; ++i) {
    BodyState& body = island.bodies[static_cast<std::size_t>(i)];
    if (!body.is_pushed) continue;
    const Vector3d velocity_before = body.velocity, spin_before = body.spin;
    body.velocity += (duration * body.inverse_mass) * body.force;
    body.angular_momentum += duration * body.torque;
    body.spin = spin_of(body);
    const Vector3d mean_velocity = 0.5 * (velocity_before + body.velocity);
    const Vector3d mean_spin = 0.5 * (spin_before + body.spin);
    if (body.is_touched) {
      books.damping_work -=
          duration * (body.damping_force.dot(mean_velocity) + body.damping_torque.dot(mean_spin));
      books.friction_work -=
          duration * (body.friction_force.dot(mean_velocity) + body.friction_torque.dot(mean_spin));
    }
    books.outside_work +=
        duration * (body.outside_force.dot(mean_velocity) + body.outside_torque.dot(mean_spin));
    books.impulse += duration * body.outside_load;
    books.angular_impulse += duration * body.outside_moment;
    books.impulse_size += duration * body.load_size;
    books.angular_impulse_size += duration * body.moment_size;
    check_finite(body, books);
  }
}

/// Loads without contacts.
void begin_loads(BodyState& body, const Vector3d& gravity) {
  if (body.is_touched) {
    body.damping_force.setZero();
    body.damping_torque.setZero();
    body.friction_force.setZero();
    body.friction_torque.setZero();
    body.is_touched = false;
  }
  body.force.setZero();
  body.torque.setZero();
  if (!body.is_free()) return;
  body.outside_load = body.mass * gravity + body.outside_force;
  body.force = body.outside_load;
  body.torque = body.outside_torque;
}

/// What the books take of a free body's loads in every kick by them.
void sum_loads(BodyState& body) {
  body.is_pushed =
      body.is_touched || !body.outside_load.isZero(0) || !body.outside_torque.isZero(0);
  if (!body.is_pushed) return;
  body.outside_moment = body.position.cross(body.outside_load) + body.outside_torque;
  body.load_size = body.force.norm();
  body.moment_size = (body.position.cross(body.force) + body.torque).norm();
}

/// The points of a pair that are pressed in.
struct Touching {
  int num_points = 0;
  double weight = 0;  // sum
};

/// One point's forces at the present state.
void apply(LocalPair& local, ContactPoint& point, const Touching& touching, double drift,
           const ContactSettings& settings, Island& island) {
  const double compression = point.depth - point.offset;
  if (compression <= 0) {
    point.is_touching = false;
    point.stretch_b.setZero();
    point.rolled_b.setZero();
    point.shear = 0;
    point.load = 0;
    return;
  }
  point.is_touching = true;
  BodyState& a = body_a(island, local);
  BodyState& b = body_b(island, local);
  a.is_touched = b.is_touched = true;
  const Vector3d& n = point.normal;
  const Vector3d velocity = a.velocity_at(point.place) - b.velocity_at(point.place);
  const double closing = -n.dot(velocity);
  const double inverse_mass = inverse_pair_mass(a, b);
  const NormalSpring spring = normal_spring(local, point.weight, touching.weight, compression,
                                            inverse_mass, settings.contact_law);
  const double k = spring.stiffness;
  // The damping alone is taken implicitly, with all points of the pair acting on the same mass.
  double damping = k * spring.relaxation /
                   (1 + 0.5 * drift * touching.num_points * k * spring.relaxation * inverse_mass);
  if (damping * drift * inverse_mass * std::max(1.5 * touching.num_points, kMostLever) > 2) {
    // A corner far from the centre of mass is lighter than the bodies: no damper may turn it round.
    const double lightest =
        std::max(1.5 * touching.num_points * inverse_mass, inverse_mass_at(point, a, b));
    damping = std::min(damping, 2 / (drift * lightest));
  }
  const double load = std::max(0.0, spring.force + damping * closing);
  const double damped = load - spring.force;
  const Vector3d sliding = velocity + closing * n;
  const Grip grip{sliding, load, damping, k, touching.num_points, drift};
  double sheared = 0;
  const Vector3d friction = friction_force(local, point, a, b, grip, settings, sheared);
  point.load = load;
  if (local.pair.law.rolling_friction > 0) {
    double rolled = 0;
    const Vector3d torque = rolling_torque(local, point, a, b, grip, settings, rolled);
    sheared += rolled;
    a.torque += torque;
    b.torque -= torque;
    a.friction_torque += torque;
    b.friction_torque -= torque;
  }

  const Vector3d force = load * n + friction;
  const Vector3d arm_a = point.place - a.position, arm_b = point.place - b.position;
  a.force += force;
  a.torque += arm_a.cross(force);
  b.force -= force;
  b.torque -= arm_b.cross(force);
  if (damped != 0) {
    const Vector3d damped_force = damped * n;
    a.damping_force += damped_force;
    a.damping_torque += arm_a.cross(damped_force);
    b.damping_force -= damped_force;
    b.damping_torque -= arm_b.cross(damped_force);
  }
  if (!friction.isZero(0)) {
    a.friction_force += friction;
    a.friction_torque += arm_a.cross(friction);
    b.friction_force -= friction;
    b.friction_torque -= arm_b.cross(friction);
  }
  island.books.elastic_energy += spring.energy + sheared;
  island.books.shear_energy += sheared;
  island.books.overlap_total += point.depth;
  island.books.squared_overlap_total += point.depth * point.depth;
  island.books.num_overlaps += 1;
  island.books.max_overlap = std::max(island.books.max_overlap, point.depth);
}

/// The fastest approach (m/s) of the island's touching pairs, 0 if none of them is elastic.
double fastest_elastic_impact(const Island& island, const ContactSettings& settings) {
  const bool is_any_elastic =
      std::any_of(island.pairs.begin(), island.pairs.end(), [](const LocalPair& local) {
        return local.pair.is_touching && local.pair.law.restitution >= kElastic;
      });
  if (!is_any_elastic) return 0;
  double fastest = 0;
  for (const LocalPair& local : island.pairs) {
    if (!local.pair.is_touching) continue;
    fastest = std::max(fastest, fastest_closing(local, island.bodies, settings));
  }
  return fastest;
}

/// True if nothing presses the pair in, compared with `energy` (J): to stiffen it costs nothing.
bool is_unpressed(const ContactPair& pair, double energy) {
  double stored = 0;
  for (const ContactPoint& point : pair.points) stored += normal_energy(pair, point);
  return stored <= kUnpressed * energy;
}

/// Stiffness and damping scale follow what the pair goes through now. `impact` (m/s): the island's
/// fastest, which an elastic pair that nothing presses in yet awaits.
void adapt(LocalPair& local, Island& island, double drift, double impact,
           const ContactSettings& settings) {
  ContactPair& pair = local.pair;
  const BodyState& a = body_a(island, local);
  const BodyState& b = body_b(island, local);
  const double mass = 1 / inverse_pair_mass(a, b);
  const double fastest = fastest_closing(local, island.bodies, settings);
  double heaviest = 0;
  for (const ContactPoint& point : pair.points) {
    if (point.depth < -touch_gap(settings)) continue;
    heaviest = std::max(heaviest, point.load / point.weight);
  }
  const bool is_compressing = fastest > 0;
  if (is_compressing && !pair.is_compressing) {
    // A new compression without separation in between: its own speed is the scale.
    pair.approach_speed = least_approach_speed(settings);
  }
  // Never below what goes on now: another corner may land faster, and a damper scaled with a far
  // lower speed would push back more than it stops.
  pair.approach_speed = std::max(pair.approach_speed, fastest);
  pair.is_compressing = is_compressing;
  pair.mean_load += std::min(1.0, drift / kLoadMemory) * (heaviest - pair.mean_load);
  if (settings.contact_law == NormalLaw::kHertzMindlin) {
    const double depth = pair.points.empty() ? 0 : pair.points.front().depth;
    pair.stiffness = hertz_step_stiffness(pair.law, mass, pair.approach_speed, depth);
    return;
  }
  if (settings.stiffness > 0) return;
  const double ratio = fastest / settings.impact_depth;
  double wanted = is_compressing ? mass * ratio * ratio : 0;
  if (!is_compressing && pair.mean_load > 1.2 * pair.stiffness * settings.rest_depth) {
    wanted = std::min(1.5 * pair.stiffness, pair.mean_load / settings.rest_depth);
  }
  const double awaited = mass * std::pow(impact / settings.impact_depth, 2);
  if (pair.law.restitution >= kElastic && awaited > wanted &&
      is_unpressed(pair, 0.5 * mass * impact * impact)) {
    wanted = awaited;
  }
  if (wanted > pair.stiffness) {
    island.books.damping_work += stiffen(pair, wanted);
  }
}

}  // namespace

void evaluate_contact_forces(Island& island, double drift, const ContactSettings& settings) {
  for (BodyState& body : island.bodies) begin_loads(body, settings.gravity);
  // What leaves the tangential springs without work on the bodies is slip.
  const double shear_energy = island.books.shear_energy;
  island.books.elastic_energy = island.books.shear_energy = 0;
  long num_contacts = 0;
  const double impact = fastest_elastic_impact(island, settings);
  for (LocalPair& local : island.pairs) {
    if (!local.pair.is_touching) continue;
    if (drift > 0) adapt(local, island, drift, impact, settings);
    Touching touching;
    for (const ContactPoint& point : local.pair.points) {
      if (point.depth <= point.offset) continue;
      ++touching.num_points;
      touching.weight += point.weight;
    }
    for (ContactPoint& point : local.pair.points) {
      apply(local, point, touching, drift, settings, island);
    }
    num_contacts += touching.num_points;
  }
  for (int i = 0; i < island.num_free; ++i) {
    sum_loads(island.bodies[static_cast<std::size_t>(i)]);
  }
  island.books.friction_work += shear_energy - island.books.shear_energy;
  island.books.max_contacts = std::max(island.books.max_contacts, num_contacts);
  island.has_forces = true;
}

double explicit_step(Island& island, double longest, const ContactSettings& settings) {
  const double touch_down = touch_gap(settings);
  double step = longest;
  bool is_any_touching = false;
  for (LocalPair& local : island.pairs) {
    if (!local.pair.is_touching && local.pair.gap <= touch_down) {
      look_and_book(local, island, settings.impact_depth);
      update_contact(local, island, settings, touch_down);
    } else if (local.pair.is_touching && !island.has_forces) {
      look_and_book(local, island, settings.impact_depth);
      update_contact(local, island, settings, touch_down);
      // It may come from a step at rest, whose speeds are no scale for what begins now.
      local.pair.approach_speed =
          std::max(local.pair.approach_speed, fastest_closing(local, island.bodies, settings));
    }
    is_any_touching = is_any_touching || local.pair.is_touching;
  }
  if (is_any_touching) step = std::min(step, contact_step(island, settings));
  const bool is_tethered = !island.tethers.empty();
  for (BodyState& body : island.bodies) body.other_acceleration = 0;
  if (is_tethered) step = std::min(step, tether_step(island, settings.gravity));
  if (settings.wind) step = wind_step(island, *settings.wind, settings.gravity, step);
  for (const LocalPair& local : island.pairs) {
    step = time_to_meet(local, island, step, settings);
  }
  if (!island.has_forces) evaluate_contact_forces(island, 0, settings);
  const auto kick_first_half = [&](double duration) {
    if (settings.wind) blow(island, 0.5 * duration, *settings.wind);
    kick(island, 0.5 * duration);
  };
  if (is_tethered) {
    tighten(island);
    step = drift_on_tethers(island, step, kick_first_half);
  } else {
    kick_first_half(step);
  }
  for (LocalPair& local : island.pairs) {
    if (local.pair.is_touching || has_corners(local, island)) continue;
    const Approach approach = approach_of(local, island, settings.gravity);
    local.pair.gap -= std::max(0.0, approach.speed) * step;
  }
  for (int i = 0; i < (is_tethered ? 0 : island.num_free); ++i) {
    drift_body(island.bodies[static_cast<std::size_t>(i)], step);
  }
  island.time += step;
  for (BodyState& body : island.bodies) {
    if (body.path != nullptr) follow_path(body, island.time);
  }
  for (LocalPair& local : island.pairs) {
    if (!local.pair.is_touching) {
      if (has_corners(local, island)) local.pair.gap = corner_gap(local, island);
      continue;
    }
    const Approach approach = fastest_approach(local, island, settings.gravity);
    const double margin = 2 * step * (approach.speed + step * approach.acceleration);
    look_and_book(local, island, std::max(settings.impact_depth, margin), step);
  }
  evaluate_contact_forces(island, step, settings);
  kick(island, 0.5 * step);
  if (settings.wind) blow(island, 0.5 * step, *settings.wind);
  if (is_tethered) hold_velocities(island);
  for (LocalPair& local : island.pairs) {
    if (local.pair.is_touching) update_contact(local, island, settings, touch_down);
    local.pair.is_in_impact = local.pair.is_touching;
  }
  count_step(island.books, step);
  return step;
}

}  // namespace verisim::dem
