// SPDX-License-Identifier: MIT
#include "dem/rest_step.h"

#include <algorithm>
#include <cmath>

#include "dem/contact_tracking.h"
#include "dem/explicit_step.h"
#include "dem/rest_problem.h"
#include "dem/rotation.h"
#include "dem/wind.h"

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

// A rise of energy below this share of what lifts the island by the depth of rest is rounding.
constexpr double kUnseenRise = 1e-3;
// Stiffness grows by no more than this factor at a time: resting loads are found at once, the
// spike of an impact must not stiffen what rests afterwards.
constexpr double kMostStiffening = 100, kMostStiffeningInImpact = 4;
constexpr int kMostSolves = 5;
// Depths of rest that an impact may press in a spring.
constexpr double kImpactDepth = 4;
// Load of a spring, of what presses it in by the depth of rest, beyond which it is stiffened and
// below which it may soften. Wide apart, so that a load that swings a little moves neither.
constexpr double kOverload = 1.5, kUnderload = 0.3;
// A step that ends deeper than it aimed at, by more depths of rest than this (less where little
// room is left), is too long.
constexpr double kSurprise = 5;
// Offsets from the projected path smaller than this share of the depth of rest are left out.
constexpr double kUnseenShift = 1e-4;
// Depths of rest by which an offset may shrink in a step, and the share of what the step dissipated
// that may pay for it.
constexpr double kRecovery = 0.5, kRecoveryShare = 0.5;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

struct SpringEnergy {
  double normal = 0, shear = 0;  // J
  double total() const { return normal + shear; }
};

SpringEnergy spring_energy(const Island& island, double tangential_ratio) {
  SpringEnergy sum;
  for (const LocalPair& local : island.pairs) {
    for (const ContactPoint& point : local.pair.points) {
      if (point.depth <= point.offset) continue;
      const double k = local.pair.stiffness * point.weight;
      sum.normal += normal_energy(local.pair, point);
      sum.shear += 0.5 * tangential_ratio * k * point.stretch_b.squaredNorm();
    }
  }
  return sum;
}

double kinetic_energy(const Island& island) {
  double sum = 0;
  for (int i = 0; i < island.num_free; ++i) {
    const BodyState& body = island.bodies[at(i)];
    sum +=
        0.5 * body.mass * body.velocity.squaredNorm() + 0.5 * body.angular_momentum.dot(body.spin);
  }
  return sum;
}

double kinetic_and_potential(const Island& island, const Vector3d& gravity) {
  double sum = kinetic_energy(island);
  for (int i = 0; i < island.num_free; ++i) {
    const BodyState& body = island.bodies[at(i)];
    sum -= body.mass * gravity.dot(body.position);
  }
  return sum;
}

/// How far the surfaces of a pair can come closer within `duration`.
double reach_of(const LocalPair& local, const Island& island, double duration,
                const ContactSettings& settings) {
  const auto speed = [&](const BodyState& body) {
    return body.velocity.norm() + body.spin.norm() * body.reach +
           (body.is_free() ? settings.gravity.norm() * duration : 0);
  };
  return settings.impact_depth +
         duration * (speed(island.bodies[at(local.a)]) + speed(island.bodies[at(local.b)]));
}

double weight_of(const LocalPair& local, const Island& island, const ContactSettings& settings) {
  return settings.gravity.norm() /
         inverse_pair_mass(island.bodies[at(local.a)], island.bodies[at(local.b)]);
}

/// Stiffness for the load of rest: springs that do not touch take it at once; those that do may
/// sink into it by halves, at fixed depth, where energy can only fall.
void relax_stiffness(LocalPair& local, Island& island, const ContactSettings& settings) {
  ContactPair& pair = local.pair;
  if (settings.stiffness > 0) {
    pair.stiffness = settings.stiffness;
    return;
  }
  double load = weight_of(local, island, settings);
  bool is_pressed = false, has_offset = false;
  for (const ContactPoint& point : pair.points) {
    load = std::max(load, point.load / point.weight);
    is_pressed = is_pressed || point.depth > point.offset;
    has_offset = has_offset || point.offset > 0;
  }
  const double wanted = load / settings.rest_depth;
  if (!pair.is_touching || !is_pressed) {
    pair.stiffness = wanted;
    for (ContactPoint& point : pair.points) point.offset = std::max(0.0, point.depth);
  } else if (wanted < kUnderload * pair.stiffness && !has_offset) {
    const double softer = std::max(wanted, 0.5 * pair.stiffness);
    double squares = 0;
    for (const ContactPoint& point : pair.points) {
      squares += point.weight * std::pow(std::max(0.0, point.depth), 2);
    }
    const double given_up = 0.5 * (pair.stiffness - softer) * squares;
    island.books.damping_work += given_up;
    pair.stiffness = softer;
  }
}

/// Raises the stiffness of overloaded pairs; true if any was raised.
bool stiffen_overloaded(RestProblem& problem, Island& island, const ContactSettings& settings) {
  if (settings.stiffness > 0) return false;
  bool is_raised = false;
  std::vector<RestRow>& rows = problem.rows();
  for (std::size_t first = 0; first < rows.size();) {
    LocalPair& local = *rows[first].local;
    double load = 0, fastest = 0;
    bool is_pressed = false;
    std::size_t r = first;
    for (; r < rows.size() && rows[r].local == &local; ++r) {
      load = std::max(load, rows[r].load / rows[r].point->weight);
      const Vector3d u = relative_velocity(rows[r], problem.start_velocities());
      if (rows[r].load > 0) fastest = std::max(fastest, -rows[r].normal.dot(u));
      is_pressed = is_pressed || rows[r].compression > 0;
    }
    double most = kMostStiffening, depth = settings.rest_depth;
    if (fastest > least_impact_speed(settings)) {
      depth *= kImpactDepth;
      if (is_pressed) most = kMostStiffeningInImpact;
    }
    first = r;
    const double k = local.pair.stiffness;
    if (load <= kOverload * k * depth) continue;
    const double raised = std::min(load / depth, most * k);
    island.books.damping_work += stiffen(local.pair, raised);
    is_raised = true;
  }
  return is_raised;
}

/// Leaves out the offsets of bodies that something presses on.
void leave_to_fliers(const std::vector<RestRow>& rows, std::vector<Vector6>& shift) {
  for (const RestRow& row : rows) {
    if (row.load <= 0) continue;
    if (row.a >= 0) shift[at(row.a)].setZero();
    if (row.b >= 0) shift[at(row.b)].setZero();
  }
}

/// Leaves out the offsets of bodies that they would push into surfaces that the solution keeps
/// apart or presses in less.
void stop_at_surfaces(const std::vector<RestRow>& rows, const std::vector<Vector6>& end, double h,
                      double tolerance, std::vector<Vector6>& shift) {
  const auto is_in_the_way = [&](const RestRow& row) {
    const double aimed_at = row.compression - h * row.normal.dot(relative_velocity(row, end));
    const double in = row.normal.dot(row.given - relative_velocity(row, shift));
    return in > 0 && aimed_at + in > std::max(0.0, aimed_at) + tolerance;
  };
  const auto drop = [&](int body) {
    if (body >= 0) shift[at(body)].setZero();
  };
  for (bool is_any = true; is_any;) {
    is_any = false;
    for (const RestRow& row : rows) {
      if (!is_in_the_way(row)) continue;
      drop(row.a);
      drop(row.b);
      is_any = true;
    }
  }
}

/// Moves the bodies by the solution; the books take what springs, friction and the step took.
/// Returns the energy (J) of the normal springs that it aims at.
double move(RestProblem& problem, Island& island, double h, const ContactSettings& settings) {
  const std::vector<Vector6>& start = problem.start_velocities();
  const std::vector<Vector6>& end = problem.velocities();
  // Displacement by the mean of both velocities is second order; by the end's alone it is what the
  // springs were balanced for. The difference is kept where no spring minds.
  std::vector<Vector6> shift(end.size());
  double largest = 0;
  for (std::size_t i = 0; i < end.size(); ++i) {
    shift[i] = 0.5 * h * (start[i] - end[i]);
    largest = std::max(
        {largest, shift[i].head<3>().norm(), shift[i].tail<3>().norm() * island.bodies[i].reach});
  }
  const std::vector<Vector6> whole_shift = shift;
  // An impact changes velocities within the step, not over it: no mean to go by, and a shift across
  // the velocity would turn the angular momentum.
  double impact = 0;
  for (const RestRow& row : problem.rows()) {
    if (row.load <= 0) continue;
    impact = std::max(impact, -row.normal.dot(relative_velocity(row, start)));
  }
  const bool is_smooth = impact <= least_impact_speed(settings);
  if (is_throng(island)) {
    leave_to_fliers(problem.rows(), shift);
    stop_at_surfaces(problem.rows(), end, h, settings.rest_depth, shift);
  } else if (is_smooth && largest > kUnseenShift * settings.rest_depth) {
    problem.project(shift);
    stop_at_surfaces(problem.rows(), end, h, settings.rest_depth, shift);
  } else {
    for (Vector6& s : shift) s.setZero();
  }

  IslandBooks& books = island.books;
  double aimed_at = 0;
  std::vector<Vector6> impulse(end.size(), Vector6::Zero());
  for (RestRow& row : problem.rows()) {
    const Vector3d u_start = relative_velocity(row, start);
    const Vector3d u_end = relative_velocity(row, end);
    const Vector3d u_mean = 0.5 * (u_start + u_end);
    const Vector3d& n = row.normal;
    const Vector3d shifted = relative_velocity(row, shift) - row.given;
    const double after = row.compression - n.dot(h * u_end + shifted);
    const double stored = 0.5 * row.stiffness * std::pow(std::max(0.0, after), 2);
    const double was_stored = 0.5 * row.stiffness * std::pow(std::max(0.0, row.compression), 2);
    aimed_at += stored;
    books.damping_work -= h * row.load * n.dot(u_mean) + stored - was_stored;
    Vector3d stretch = row.stretch + h * (u_end - n.dot(u_end) * n);
    double limit =
        std::min(row.bound, row.friction * row.stiffness * std::max(0.0, after)) / row.shear;
    if (row.is_softened) limit = std::min(limit, row.tangential.norm() / row.shear);
    if (stretch.norm() > limit) {
      stretch *= limit / stretch.norm();
      row.point->has_slid = true;
    }
    books.friction_work -= h * row.tangential.dot(u_mean);
    row.stretch = stretch;
    row.point->load = row.load;
    row.point->expected = row.point->depth + after - row.compression;
    const Vector3d force = row.load * n + row.tangential;
    if (row.a < 0 || row.b < 0) {
      const double sign = row.a < 0 ? -1 : 1;  // the free body gets sign * force
      books.impulse += (sign * h) * force;
      books.angular_impulse += (sign * h) * row.point->place.cross(force);
      books.outside_work -= h * force.dot(row.given);
    }
    const auto give = [&](int body, const Vector3d& arm, double sign) {
      if (body < 0) return;
      impulse[at(body)].head<3>() += (sign * h) * force;
      impulse[at(body)].tail<3>() += (sign * h) * arm.cross(force);
    };
    give(row.a, row.arm_a, 1);
    give(row.b, row.arm_b, -1);
  }
  for (std::size_t i = 0; i < end.size(); ++i) {
    BodyState& body = island.bodies[i];
    const Vector3d mean_velocity = 0.5 * (start[i] + end[i]).head<3>();
    const Vector3d mean_spin = 0.5 * (start[i] + end[i]).tail<3>();
    books.outside_work +=
        h * (body.outside_force.dot(mean_velocity) + body.outside_torque.dot(mean_spin));
    // Gravity acts along the path, the velocities change along their mean.
    books.damping_work -= body.mass * settings.gravity.dot((whole_shift[i] - shift[i]).head<3>());
    const Vector3d outside = body.mass * settings.gravity + body.outside_force;
    books.impulse += h * outside;
    books.angular_impulse += h * (body.position.cross(outside) + body.outside_torque);
    books.impulse_size += h * outside.norm() + impulse[i].head<3>().norm();
    books.angular_impulse_size +=
        h * body.position.cross(outside).norm() +
        (body.position.cross(Vector3d(impulse[i].head<3>())) + impulse[i].tail<3>()).norm();
    const Vector3d start_velocity = body.velocity;
    body.velocity = start_velocity +
                    h * (settings.gravity + body.inverse_mass * body.outside_force) +
                    body.inverse_mass * impulse[i].head<3>();
    body.angular_momentum += h * body.outside_torque + impulse[i].tail<3>();
    refresh(body);
    drift_body(body, h);
    body.position += shift[i].head<3>();
    const double spinning = 0.5 * body.angular_momentum.dot(body.spin);
    body.orientation = (rotation_of(shift[i].tail<3>()) * body.orientation).normalized();
    refresh(body);
    // The shift turns the body's axes under its angular momentum.
    books.damping_work += spinning - 0.5 * body.angular_momentum.dot(body.spin);
    check_finite(body, books);
  }
  island.time += h;
  for (BodyState& body : island.bodies) {
    if (body.path != nullptr) follow_path(body, island.time);
  }
  return aimed_at;
}

/// What surfaces turned towards each other within the step presses no spring in: the offset takes
/// it, and no energy comes of it.
void leave_to_offset(ContactPoint& point) {
  const double aimed_at = std::max(0.0, point.expected - point.offset);
  point.offset = std::max(point.offset, point.depth - aimed_at);
}

/// Lets springs come out of their offsets, as far as `spent` (J) pays for what that puts into them.
/// Returns what it took (J).
double recover_offsets(Island& island, double spent, const ContactSettings& settings) {
  const auto most = [&](const ContactPoint& point) {
    return std::min(point.offset, kRecovery * settings.rest_depth);
  };
  const auto cost = [&](const ContactPair& pair, const ContactPoint& point, double way) {
    const double compression = std::max(0.0, point.depth - point.offset);
    return pair.stiffness * point.weight * way * (compression + 0.5 * way);
  };
  double whole = 0;
  for (const LocalPair& local : island.pairs) {
    for (const ContactPoint& point : local.pair.points) {
      if (point.is_touching) whole += cost(local.pair, point, most(point));
    }
  }
  if (!(whole > 0) || !(spent > 0)) return 0;
  const double share = std::min(1.0, spent / whole);
  double taken = 0;
  for (LocalPair& local : island.pairs) {
    for (ContactPoint& point : local.pair.points) {
      if (!point.is_touching) continue;
      const double way = share * most(point);
      taken += cost(local.pair, point, way);
      point.offset -= way;
    }
  }
  return taken;
}

/// Stretches turn with body b; contacts begin and end. Returns how much deeper a pair lies than it
/// was and than the step aimed at, as a share of what it may: surfaces met where none was seen.
double keep_contacts(RestProblem& problem, Island& island, const ContactSettings& settings,
                     double look_ahead) {
  for (RestRow& row : problem.rows()) {
    const BodyState& b = island.bodies[at(row.local->b)];
    row.point->stretch_b = b.rotation.transpose() * row.stretch;
  }
  long num_contacts = 0;
  double surprise = 0;
  for (LocalPair& local : island.pairs) {
    ContactPair& pair = local.pair;
    double fastest = 0, aim = 0;
    bool is_loaded = false;
    for (ContactPoint& point : pair.points) {
      aim = std::max({aim, point.expected, point.depth});
      point.depth = point.expected;
      if (point.load <= 0) continue;
      is_loaded = true;
      fastest = std::max(fastest, std::abs(closing_speed(local, island.bodies, point)));
    }
    if (is_loaded && !pair.is_touching) {
      record_event(island, local, ContactChange::kBegin, fastest);
    }
    pair.is_touching = pair.is_touching || is_loaded;
    pair.is_compressing = false;
    pair.is_in_impact = false;
    pair.approach_speed = least_approach_speed(settings);
    look_and_book(local, island, reach_of(local, island, look_ahead, settings));
    double deepest = -1;
    double heaviest = 0;
    for (ContactPoint& point : pair.points) {
      leave_to_offset(point);
      deepest = std::max(deepest, point.depth);
      heaviest = std::max(heaviest, point.load / point.weight);
      if (point.depth <= point.offset) {
        point.stretch_b.setZero();
        point.load = 0;
        point.is_touching = false;
        point.offset = std::max(0.0, point.depth);
        continue;
      }
      point.is_touching = true;
      ++num_contacts;
      island.books.overlap_total += point.depth;
      island.books.squared_overlap_total += point.depth * point.depth;
      island.books.num_overlaps += 1;
      island.books.max_overlap = std::max(island.books.max_overlap, point.depth);
    }
    pair.mean_load = heaviest;
    surprise = std::max(surprise, (deepest - aim) / room(aim, kSurprise, settings));
    if (pair.is_touching && deepest <= 0 && !is_loaded) {
      pair.is_touching = false;
      record_event(island, local, ContactChange::kEnd, 0);
    }
  }
  island.books.max_contacts = std::max(island.books.max_contacts, num_contacts);
  return surprise;
}

/// Bodies and pairs at the start of a step that may be taken back.
struct Before {
  std::vector<BodyState> bodies;
  std::vector<LocalPair> pairs;
  IslandBooks books;
  double time;
};

}  // namespace

bool rest_step(Island& island, double duration, const ContactSettings& settings) {
  thread_local Before before;  // keeps its memory from step to step
  before.bodies = island.bodies;
  before.pairs = island.pairs;
  const HeldWind held(island, settings.wind);
  before.books = island.books;
  before.time = island.time;
  for (LocalPair& local : island.pairs) {
    look_and_book(local, island, reach_of(local, island, duration, settings));
  }
  const double shear_start = spring_energy(island, settings.tangential_ratio).shear;
  for (LocalPair& local : island.pairs) {
    relax_stiffness(local, island, settings);
  }
  const SpringEnergy springs_start = spring_energy(island, settings.tangential_ratio);
  const double energy_start =
      kinetic_and_potential(island, settings.gravity) + springs_start.total();
  const double outside_start = island.books.outside_work;
  const double damping_start = island.books.damping_work;
  const double friction_start = island.books.friction_work;

  int newton_steps = 0;
  const auto take_back = [&] {
    island.bodies = before.bodies;
    island.pairs = before.pairs;
    island.books = before.books;
    island.books.num_newton_steps += newton_steps;
    ++island.books.num_refused_steps;
    island.time = before.time;
  };
  thread_local RestProblem problem;  // knows the pattern of its matrix again
  problem.set_up(island, duration, settings);
  for (int i = 0; i + 1 < kMostSolves; ++i) {
    const RestProblem::Outcome rough = problem.solve(true);
    newton_steps += rough.newton_steps;
    if (!rough.converged && is_throng(island)) {
      take_back();
      return false;
    }
    if (!stiffen_overloaded(problem, island, settings)) break;
    problem.refresh_rows(settings);
  }
  const RestProblem::Outcome outcome = problem.solve(false);
  newton_steps += outcome.newton_steps;
  const double aimed_at = move(problem, island, duration, settings);
  const double given_up = island.books.damping_work;
  const double surprise = keep_contacts(problem, island, settings, duration);
  count_step(island.books, duration);
  ++island.books.num_rest_steps;

  SpringEnergy springs_end = spring_energy(island, settings.tangential_ratio);
  island.books.friction_work += shear_start - springs_end.shear;
  // Where surfaces turned away from each other within the step, springs hold less than it aimed at.
  const double turned_away = aimed_at - springs_end.normal - (island.books.damping_work - given_up);
  island.books.damping_work += std::max(0.0, turned_away);
  const double spent = kRecoveryShare * (island.books.damping_work - damping_start +
                                         island.books.friction_work - friction_start);
  const double recovered = recover_offsets(island, spent, settings);
  island.books.damping_work -= recovered;
  springs_end.normal += recovered;
  island.books.elastic_energy = springs_end.total();
  island.books.shear_energy = springs_end.shear;
  island.books.implicit_work += island.books.damping_work - damping_start;
  island.has_forces = false;
  const double energy_end =
      kinetic_and_potential(island, settings.gravity) + island.books.elastic_energy;
  const double rise = energy_end - energy_start - (island.books.outside_work - outside_start);
  double unseen = 0;
  for (int i = 0; i < island.num_free; ++i) {
    unseen += island.bodies[at(i)].mass * settings.gravity.norm() * settings.rest_depth;
  }
  const bool is_good = outcome.converged && rise <= kUnseenRise * unseen && surprise <= 1;
  if (!is_good) {
    take_back();
    return false;
  }
  island.books.num_newton_steps += newton_steps;
  island.books.energy_rise = std::max(island.books.energy_rise, rise);
  return true;
}

}  // namespace verisim::dem
