// SPDX-License-Identifier: MIT
#include "dem/xpbd_substep.h"

#include <algorithm>
#include <cmath>

#include "dem/contact_tracking.h"
#include "dem/flight.h"
#include "dem/rotation.h"
#include "dem/wind.h"
#include "dem/xpbd_contacts.h"
#include "dem/xpbd_impacts.h"
#include "dem/xpbd_rows.h"

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

// Sweeps over the points of one pair within a sweep over all pairs: four corners of a face share
// one load, and a single sweep would leave it on the first.
constexpr int kInnerSweeps = 4;
// Share of the smaller body's size by which two touching bodies may move against each other or turn
// before their contact points are looked for anew; what their linear motion misses is of the order
// of its square. Every frame looks anew.
constexpr double kStill = 1e-4;
// Time (s) over which an overlap that appeared without motion (a scene that starts so, a change of
// the features that meet) falls to 1/e.
constexpr double kLetOutTime = 1.0 / 60;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// What a substep carries from phase to phase.
struct Substep {
  double step = 0;               // s
  double load_time = 0;          // s, over which a correction counts as an impulse
  std::vector<Vector3d> starts;  // m, [bodies] centres before the drift
  std::vector<Rates> drifts;     // velocities of the drift
  Rows rows;                     // of positions
  std::vector<FreshPoint> fresh;
};

void drift(Island& island, Substep& s) {
  s.starts.clear();
  for (const BodyState& body : island.bodies) s.starts.push_back(body.position);
  for (int i = 0; i < island.num_free; ++i) drift_body(island.bodies[at(i)], s.step);
  island.time += s.step;
  for (BodyState& body : island.bodies) {
    if (body.path != nullptr) follow_path(body, island.time);
  }
  read_velocities(island, s.drifts);
}

/// Points of a pair that hardly moved since the last look go along with it.
void carry_points(LocalPair& local, const Island& island, const Substep& s) {
  const BodyState &a = island.bodies[at(local.a)], &b = island.bodies[at(local.b)];
  const bool is_sphere = std::holds_alternative<SphereShape>(*a.shape);
  for (ContactPoint& point : local.pair.points) {
    const Vector3d of_a = a.velocity_at(point.place), of_b = b.velocity_at(point.place);
    point.depth -= s.step * point.normal.dot(of_a - of_b);
    point.place += s.step * (is_sphere ? a.velocity : Vector3d(0.5 * (of_a + of_b)));
  }
}

/// Finds contact points where bodies are now. Pairs that were farther apart than they moved keep.
void look(Island& island, const Substep& s, const ContactSettings& settings) {
  const double margin = look_gap(settings);
  for (LocalPair& local : island.pairs) {
    const BodyState &a = island.bodies[at(local.a)], &b = island.bodies[at(local.b)];
    const Vector3d way =
        (a.position - s.starts[at(local.a)]) - (b.position - s.starts[at(local.b)]);
    const double motion = way.norm() + s.step * (edge_speed(a) + edge_speed(b));
    local.pair.gap -= motion;
    if (!local.pair.is_touching && local.pair.gap > margin) continue;
    const double still = kStill * (b.size > 0 ? std::min(a.size, b.size) : a.size);
    if (local.pair.is_touching && local.moved >= 0 && local.moved + motion < still) {
      local.moved += motion;
      carry_points(local, island, s);
      continue;
    }
    look_and_book(local, island, margin, s.step);
    local.moved = 0;
  }
}

/// Rows of all points that meet; those that came to meet faster than the threshold are impacts.
void collect(Island& island, const ContactSettings& settings, Substep& s) {
  s.rows.clear();
  s.fresh.clear();
  const double margin = look_gap(settings);
  const int num_pairs = static_cast<int>(island.pairs.size());
  for (int p = 0; p < num_pairs; ++p) {
    LocalPair& local = island.pairs[at(p)];
    if (!local.pair.is_touching && local.pair.gap > 0) continue;
    const BodyState &a = island.bodies[at(local.a)], &b = island.bodies[at(local.b)];
    const bool is_sphere = std::holds_alternative<SphereShape>(*a.shape);
    for (std::size_t i = 0; i < local.pair.points.size(); ++i) {
      ContactPoint& point = local.pair.points[i];
      if (point.depth <= -margin) continue;
      const double closing = closing_speed(local, island.bodies, point);
      // What lies deeper than the bodies moved was not seen to come: it is held there and let out
      // slowly, not thrown out.
      if (!point.is_touching) {
        point.offset = std::max(0.0, point.depth - s.step * std::max(0.0, closing));
      } else {
        point.offset -= point.offset * std::min(1.0, s.step / kLetOutTime);
      }
      const Vector3d way_a = a.position - s.starts[at(local.a)];
      if (!point.is_touching && point.depth > 0 && closing > settings.restitution_threshold) {
        s.fresh.push_back({p, static_cast<int>(i)});
        continue;
      }
      // The load acts before the drift (so that it and the drift conserve angular momentum): at the
      // place from which the point was carried here.
      const Vector3d carried =
          is_sphere
              ? way_a
              : Vector3d(0.5 * s.step * (a.velocity_at(point.place) + b.velocity_at(point.place)));
      Row& row = add_row(s.rows, island, p, static_cast<int>(i), point.place - carried,
                         s.starts[at(local.a)], s.starts[at(local.b)]);
      row.target = point.depth - point.offset;
      row.slip = b.rotation * point.stretch_b +
                 s.step * (a.velocity_at(point.place) - b.velocity_at(point.place));
    }
  }
}

/// Moves bodies by the corrections; momenta take what they mean over the step.
void correct_positions(Island& island, const ContactSettings& settings, Substep& s) {
  thread_local std::vector<Rates> corrections, before, after;
  thread_local std::vector<Vector3d> momenta;
  corrections.assign(island.bodies.size(), Rates{});
  sweep_loads(s.rows, island, kInnerSweeps, corrections);
  sweep_grips(s.rows, island, kInnerSweeps, corrections);

  read_velocities(island, before);
  momenta.clear();
  double lifted = 0, turned = 0;
  for (int i = 0; i < island.num_free; ++i) {
    BodyState& body = island.bodies[at(i)];
    momenta.push_back(body.angular_momentum);
    const Rates& correction = corrections[at(i)];
    if (correction.linear.isZero(0) && correction.angular.isZero(0)) continue;
    body.position += correction.linear;
    body.orientation = (rotation_of(correction.angular) * body.orientation).normalized();
    body.path_low = body.path_low.cwiseMin(body.position);
    body.path_high = body.path_high.cwiseMax(body.position);
    lifted -= body.mass * settings.gravity.dot(correction.linear);
    refresh(body);
  }
  add_momenta(s.rows, 1 / s.load_time, island);
  read_velocities(island, after);
  book_loads(s.rows, 1 / s.load_time, before, after, island);
  // The corrections stand for a drift with the velocities after the loads, of which the two kicks
  // have seen one half; turned bodies spin otherwise at the same angular momentum.
  for (int i = 0; i < island.num_free; ++i) {
    const BodyState& body = island.bodies[at(i)];
    turned +=
        0.5 * (momenta[at(i)].dot(body.spin) - body.angular_momentum.dot(before[at(i)].angular));
  }
  island.books.damping_work -= 0.5 * lifted + turned;
  island.books.correction_work -= 0.5 * lifted + turned;

  for (const Row& row : s.rows.rows) {
    ContactPoint& point = island.pairs[at(row.pair)].pair.points[at(row.point)];
    const BodyState& b = island.bodies[at(row.b)];
    const Vector3d moved = relative_rate(row, corrections);
    point.depth -= row.normal.dot(moved);
    point.is_touching = row.load > 0;
    if (!point.is_touching || row.slides) {
      point.stretch_b.setZero();
      point.has_slid = point.has_slid || row.slides;
    } else {
      const Vector3d left = row.slip + moved;
      point.stretch_b = b.rotation.transpose() * (left - row.normal.dot(left) * row.normal);
    }
  }
}

/// Stops what loaded points still do along their normals, slows or stops it across them. Starts
/// from the loads of the positions: those of the second half of the step, were nothing to change.
void correct_velocities(Island& island, Substep& s) {
  thread_local Rows rows;
  thread_local std::vector<Rates> before, rates;
  rows.clear();
  read_velocities(island, before);
  rates = before;
  const double share = 1 / s.load_time;
  for (const Row& row : s.rows.rows) {
    ContactPoint& point = island.pairs[at(row.pair)].pair.points[at(row.point)];
    point.load = 0;
    if (!(row.load > 0)) continue;
    Row& now = add_row(rows, island, row.pair, row.point, point.place,
                       island.bodies[at(row.a)].position, island.bodies[at(row.b)].position);
    now.load = 2 * share * row.load;
    now.grip = 2 * share * row.grip;
    apply_load(now, 0.5 * (now.load * now.normal + now.grip), island, rates);
  }
  sweep_loads(rows, island, kInnerSweeps, rates);
  sweep_grips(rows, island, kInnerSweeps, rates);

  std::size_t next = 0;
  for (const Row& row : s.rows.rows) {
    if (!(row.load > 0)) continue;
    Row& now = rows.rows[next++];
    ContactPoint& point = island.pairs[at(row.pair)].pair.points[at(row.point)];
    point.load = now.load / s.step;
    now.load -= share * row.load;
    now.grip -= share * row.grip;
  }
  add_momenta(rows, 1, island);
  read_velocities(island, rates);
  book_loads(rows, 1, before, rates, island);
}

void book_depths(Island& island) {
  IslandBooks& books = island.books;
  long num_contacts = 0;
  for (const LocalPair& local : island.pairs) {
    if (!local.pair.is_touching) continue;
    for (const ContactPoint& point : local.pair.points) {
      if (!point.is_touching) continue;
      ++num_contacts;
      const double depth = std::max(0.0, point.depth);
      books.overlap_total += depth;
      books.squared_overlap_total += depth * depth;
      books.num_overlaps += 1;
      books.max_overlap = std::max(books.max_overlap, depth);
    }
  }
  books.max_contacts = std::max(books.max_contacts, num_contacts);
}

/// Kinetic and potential energy (J) of the free bodies, less the work put in from outside.
double own_energy(const Island& island, const Vector3d& gravity) {
  double energy = -island.books.outside_work;
  for (int i = 0; i < island.num_free; ++i) {
    const BodyState& body = island.bodies[at(i)];
    energy += 0.5 * body.mass * body.velocity.squaredNorm() +
              0.5 * body.angular_momentum.dot(body.spin) - body.mass * gravity.dot(body.position);
  }
  return energy;
}

}  // namespace

void kick_freely(Island& island, double duration, const ContactSettings& settings) {
  if (settings.wind) blow(island, duration, *settings.wind);
  IslandBooks& books = island.books;
  for (int i = 0; i < island.num_free; ++i) {
    BodyState& body = island.bodies[at(i)];
    const Vector3d velocity_before = body.velocity, spin_before = body.spin;
    body.velocity += duration * (settings.gravity + body.inverse_mass * body.outside_force);
    body.angular_momentum += duration * body.outside_torque;
    body.spin = body.inverse_inertia * body.angular_momentum;
    books.outside_work += 0.5 * duration *
                          (body.outside_force.dot(velocity_before + body.velocity) +
                           body.outside_torque.dot(spin_before + body.spin));
    const Vector3d force = body.mass * settings.gravity + body.outside_force;
    const Vector3d torque = body.position.cross(force) + body.outside_torque;
    books.impulse += duration * force;
    books.angular_impulse += duration * torque;
    books.impulse_size += duration * force.norm();
    books.angular_impulse_size += duration * torque.norm();
  }
}

void xpbd_substep(Island& island, double step, const ContactSettings& settings) {
  thread_local Substep s;
  s.step = step;
  // A shorter step must not make the same correction a faster one.
  s.load_time = std::max(step, settings.substep);
  const double energy_before = own_energy(island, settings.gravity);

  kick_freely(island, 0.5 * step, settings);
  drift(island, s);
  look(island, s, settings);
  collect(island, settings, s);
  correct_positions(island, settings, s);
  kick_freely(island, 0.5 * step, settings);
  correct_velocities(island, s);
  if (!s.fresh.empty()) resolve_impacts(island, s.fresh, settings);
  for (LocalPair& local : island.pairs) {
    if (local.pair.is_touching || local.pair.gap <= touch_gap(settings)) {
      update_touching(local, island, settings);
    }
  }
  book_depths(island);
  count_step(island.books, step);
  island.books.energy_rise =
      std::max(island.books.energy_rise, own_energy(island, settings.gravity) - energy_before);
}

}  // namespace verisim::dem
