// SPDX-License-Identifier: MIT
// Which kind of step an island takes next.
#include <algorithm>
#include <cmath>
#include <limits>

#include "dem/contact_tracking.h"
#include "dem/explicit_step.h"
#include "dem/island.h"
#include "dem/rest_step.h"
#include "dem/wind.h"

namespace verisim::dem {
namespace {

// An island in impact rests again when all is slower than this share of the least impact.
constexpr double kCalm = 0.5;
// Explicit steps between two looks at whether an island has come to rest.
constexpr int kStepsBetweenLooks = 16;
// Gap error of one implicit step, in depths of rest, that turning bodies may make.
constexpr double kBend = 0.25, kBendInCrowd = 2;
// An implicit step is not cut below this share of the frame: explicit ones take its place there.
constexpr double kShortestRestStep = 1.0 / 256;
constexpr double kOnTime = 1e-12;  // of a frame

/// True if impacts went on when the last frame ended. Loads are not known anew yet, and at its
/// turning point an impact looks like rest.
bool may_be_in_impact(const Island& island) {
  return !island.has_forces &&
         std::any_of(island.pairs.begin(), island.pairs.end(),
                     [](const LocalPair& local) { return local.pair.is_in_impact; });
}

/// Fastest approach, or parting in a spring still compressed, at points that meet within
/// `duration`.
double impact_speed(LocalPair& local, Island& island, double duration,
                    const ContactSettings& settings) {
  const BodyState& a = island.bodies[static_cast<std::size_t>(local.a)];
  const BodyState& b = island.bodies[static_cast<std::size_t>(local.b)];
  const double g = settings.gravity.norm();
  const double bound = (a.velocity - b.velocity).norm() + a.spin.norm() * a.reach +
                       b.spin.norm() * b.reach + g * duration;
  if (local.pair.gap > bound * duration) return 0;
  look_and_book(local, island, bound * duration + settings.impact_depth);
  double fastest = 0;
  const double inverse_mass = inverse_pair_mass(a, b);
  for (const ContactPoint& point : local.pair.points) {
    const double speed = closing_speed(local, island.bodies, point);
    if (point.depth > 0) {
      fastest = std::max(fastest, std::abs(speed));
      // At the turning point of an impact nothing moves, but the spring is out of balance: what it
      // has left to give counts as speed.
      const double k = local.pair.stiffness * point.weight;
      if (!island.has_forces || !(k > 0)) continue;
      const double pull = point.normal.dot(a.inverse_mass * a.force - b.inverse_mass * b.force);
      fastest = std::max(fastest, std::abs(pull) / std::sqrt(k * inverse_mass));
      continue;
    }
    const double pull = (a.is_free() != b.is_free()) ? g : 0;
    const double at_touch = speed * speed + 2 * pull * -point.depth;
    const double time = speed > 0 ? -point.depth / speed : std::numeric_limits<double>::infinity();
    const bool meets =
        time < duration || (pull > 0 && speed + pull * duration > 0 &&
                            speed * duration + 0.5 * pull * duration * duration > -point.depth);
    if (meets) fastest = std::max(fastest, std::sqrt(std::max(0.0, at_touch)));
  }
  return fastest;
}

bool has_impact(Island& island, double duration, double speed, const ContactSettings& settings) {
  for (LocalPair& local : island.pairs) {
    if (!has_stepped_impacts(island, local.pair.law)) continue;
    if (impact_speed(local, island, duration, settings) > speed) return true;
  }
  return false;
}

/// Longest implicit step (s) over which the gaps of turning and curved surfaces are straight to
/// within the depth of rest.
double straight_step(const Island& island, const ContactSettings& settings) {
  double longest = std::numeric_limits<double>::infinity();
  for (const LocalPair& local : island.pairs) {
    if (!local.pair.is_touching) continue;
    const double error = is_crowd(island) ? room(deepest(local.pair), kBendInCrowd, settings)
                                          : kBend * settings.rest_depth;
    const BodyState& a = island.bodies[static_cast<std::size_t>(local.a)];
    const BodyState& b = island.bodies[static_cast<std::size_t>(local.b)];
    for (const BodyState* body : {&a, &b}) {
      if (!body->is_free() || std::holds_alternative<SphereShape>(*body->shape)) continue;
      const double bend = body->spin.squaredNorm() * body->reach;  // m/s^2
      if (bend > 0) longest = std::min(longest, std::sqrt(2 * error / bend));
    }
    const auto* ball_a = std::get_if<SphereShape>(a.shape);
    if (ball_a == nullptr || std::holds_alternative<PlaneShape>(*b.shape)) continue;
    const auto* ball_b = std::get_if<SphereShape>(b.shape);
    const double radius = ball_a->radius + (ball_b != nullptr ? ball_b->radius : 0);
    const double bend = (a.velocity - b.velocity).squaredNorm() / radius;
    if (bend > 0) longest = std::min(longest, std::sqrt(2 * error / bend));
  }
  return longest;
}

void advance_explicitly(Island& island, double end, double calm_speed,
                        const ContactSettings& settings) {
  const double start = island.time;
  const double on_time = kOnTime * (end - start);
  for (int steps = 1; end - island.time > on_time; ++steps) {
    explicit_step(island, end - island.time, settings);
    if (!island.books.is_finite) return;
    if (!settings.rests_implicitly || calm_speed <= 0 || steps % kStepsBetweenLooks != 0) continue;
    if (has_contact(island) && !has_impact(island, end - island.time, calm_speed, settings)) return;
  }
  island.time = end;
}

/// What the last implicit steps of its bodies say about the next one (s), at most `longest`.
double known_step(const Island& island, double longest) {
  for (int i = 0; i < island.num_free; ++i) {
    longest = std::min(longest, island.bodies[static_cast<std::size_t>(i)].next_step);
  }
  return longest;
}

/// Keeps what is known of the next implicit step, of a throng alone.
void keep_step(Island& island, double next) {
  if (!is_throng(island)) next = std::numeric_limits<double>::infinity();
  for (int i = 0; i < island.num_free; ++i) {
    island.bodies[static_cast<std::size_t>(i)].next_step = next;
  }
}

/// Implicit steps until `end` or an impact.
void advance_at_rest(Island& island, double end, double impact_at,
                     const ContactSettings& settings) {
  const double frame = end - island.time;
  const double on_time = kOnTime * frame;
  double longest = known_step(island, frame);
  while (end - island.time > on_time) {
    const double remaining = end - island.time;
    const bool is_flying = !has_contact(island) && !is_throng(island);
    if (is_flying || has_impact(island, remaining, impact_at, settings)) return;
    double step = std::min({remaining, longest, straight_step(island, settings)});
    if (settings.wind) step = wind_step(island, *settings.wind, settings.gravity, step);
    // Equal steps to the end.
    step = remaining / std::ceil(remaining / step - 1e-9);
    bool is_done = rest_step(island, step, settings);
    while (!is_done && step >= 2 * kShortestRestStep * frame) {
      step *= 0.5;
      is_done = rest_step(island, step, settings);
    }
    if (!is_done) advance_explicitly(island, island.time + step, 0, settings);
    if (!island.books.is_finite) return;
    longest = 2 * step;
    keep_step(island, longest);
  }
  island.time = end;
}

}  // namespace

void advance_island(Island& island, double end, const ContactSettings& settings) {
  const double impact = least_impact_speed(settings);
  const double frame = end - island.time;
  keep_step(island, known_step(island, frame));
  while (end - island.time > kOnTime * frame) {
    const bool may_rest = settings.rests_implicitly && impact > 0 &&
                          (has_contact(island) || is_throng(island)) && !may_be_in_impact(island) &&
                          !has_impact(island, end - island.time, impact, settings);
    if (may_rest) {
      advance_at_rest(island, end, impact, settings);
    } else {
      advance_explicitly(island, end, kCalm * impact, settings);
    }
    if (!island.books.is_finite) return;
  }
  island.time = end;
}

}  // namespace verisim::dem
