// SPDX-License-Identifier: MIT
#include "dem/xpbd.h"

#include <algorithm>
#include <cmath>

#include "dem/contact_tracking.h"
#include "dem/flight.h"
#include "dem/wind.h"
#include "dem/xpbd_contacts.h"
#include "dem/xpbd_impacts.h"
#include "dem/xpbd_substep.h"

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

constexpr double kOnTime = 1e-12;  // of a frame
// Shortest flight, of a substep, of what turns or is curved: its distance is a bound only, and
// steps that never reach it would never end. What it overlaps by then counts as met on the way.
constexpr double kShortestFlight = 1.0 / 16;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Looks at pairs that may have met: impacts are resolved, slower contacts begin.
void land(Island& island, const ContactSettings& settings) {
  std::vector<FreshPoint> fresh;
  std::vector<int> met;
  const int num_pairs = static_cast<int>(island.pairs.size());
  for (int p = 0; p < num_pairs; ++p) {
    LocalPair& local = island.pairs[at(p)];
    if (local.pair.is_touching || local.pair.gap > touch_gap(settings)) continue;
    look_and_book(local, island, look_gap(settings));
    if (local.pair.gap > touch_gap(settings)) continue;
    met.push_back(p);
    for (std::size_t i = 0; i < local.pair.points.size(); ++i) {
      const ContactPoint& point = local.pair.points[i];
      if (point.depth < -touch_gap(settings)) continue;
      if (closing_speed(local, island.bodies, point) > settings.restitution_threshold) {
        fresh.push_back({p, static_cast<int>(i)});
      }
    }
  }
  if (!fresh.empty()) {
    resolve_impacts(island, fresh, settings);
    for (LocalPair& local : island.pairs) {
      if (local.pair.is_touching) update_touching(local, island, settings);
    }
  }
  for (const int p : met) update_touching(island.pairs[at(p)], island, settings);
}

/// Longest time (s) until the pair must be looked at, while nothing touches.
double time_in_flight(const LocalPair& local, const Island& island,
                      const ContactSettings& settings) {
  const BodyState &a = island.bodies[at(local.a)], &b = island.bodies[at(local.b)];
  const Approach approach = approach_of(local, island, settings.gravity);
  const bool is_exact = local.pair.gap_is_along_normal && edge_speed(a) + edge_speed(b) == 0;
  const double shortest = is_exact ? 0 : kShortestFlight * settings.substep;
  if (local.pair.gap > touch_gap(settings)) {
    return std::max(shortest, time_to_close(local.pair.gap, approach));
  }
  // They part: until the pull has brought them back.
  const bool comes_back = approach.speed < 0 && approach.acceleration > 0;
  if (approach.speed < 0 && !comes_back) return std::numeric_limits<double>::infinity();
  const double way_back = comes_back ? -2 * approach.speed / approach.acceleration : 0;
  return std::max(way_back, kShortestFlight * settings.substep);
}

/// Free flight of a whole island, at most `longest` (s), to where two of its bodies may meet.
void fly(Island& island, double longest, const ContactSettings& settings) {
  double step = longest;
  for (BodyState& body : island.bodies) body.other_acceleration = 0;
  if (settings.wind) step = wind_step(island, *settings.wind, settings.gravity, step);
  for (const LocalPair& local : island.pairs) {
    step = std::min(step, time_in_flight(local, island, settings));
  }
  kick_freely(island, 0.5 * step, settings);
  for (LocalPair& local : island.pairs) {
    const Approach approach = approach_of(local, island, settings.gravity);
    local.pair.gap -= std::max(0.0, approach.speed) * step;
  }
  for (int i = 0; i < island.num_free; ++i) drift_body(island.bodies[at(i)], step);
  island.time += step;
  for (BodyState& body : island.bodies) {
    if (body.path != nullptr) follow_path(body, island.time);
  }
  kick_freely(island, 0.5 * step, settings);
  for (int i = 0; i < island.num_free; ++i) check_finite(island.bodies[at(i)], island.books);
  count_step(island.books, step);
}

}  // namespace

void advance_xpbd(Island& island, double end, const ContactSettings& settings) {
  const double on_time = kOnTime * (end - island.time);
  while (end - island.time > on_time && island.books.is_finite) {
    land(island, settings);
    const double remaining = end - island.time;
    if (has_contact(island)) {
      // Equal substeps to the end of the frame.
      const double count = std::max(1.0, std::round(remaining / settings.substep));
      xpbd_substep(island, remaining / count, settings);
    } else {
      fly(island, remaining, settings);
    }
  }
  island.time = end;
  // What the run reports is where surfaces are now, not where the last correction aimed.
  for (LocalPair& local : island.pairs) {
    if (local.pair.is_touching) look_and_book(local, island, look_gap(settings));
  }
}

}  // namespace verisim::dem
