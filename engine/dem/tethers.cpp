// SPDX-License-Identifier: MIT
#include "dem/tethers.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "dem/explicit_step.h"

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

// Phase (rad) that a swing goes through in one step: its period is then right to 4e-6.
constexpr double kPhaseOfStep = 0.01;
// The same of its rocking about the end of a line, faster and mostly unseen.
constexpr double kRockingOfStep = 0.05;
// Turn (rad) of a tethered body in one step.
constexpr double kTurnOfStep = 0.03;
// Error of length, as a share of it, at which a line counts as full or as held.
constexpr double kFull = 1e-9, kHeld = 1e-14;
// Iterations that gain less than this factor have met rounding.
constexpr double kLeastGain = 0.5;
constexpr double kRounding = 1e-11;
constexpr int kMostIterations = 30;
constexpr int kBisections = 40;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// One direction in which lines hold: of a line along it, of a ball joint every axis.
struct Row {
  std::size_t tether;
  Vector3d direction;     // unit, from the body to the anchor
  Vector3d arm_a, arm_b;  // m, world axes, from the centres of mass
  bool may_push;
};

struct Ends {
  Vector3d a, b;  // m, world: the point of the body, the anchor
  Vector3d arm_a, arm_b;
};

Ends ends_of(const Island& island, const Tether& tether) {
  Ends ends;
  const BodyState& a = island.bodies[at(tether.a)];
  ends.arm_a = a.rotation * tether.attach_b;
  ends.a = a.position + ends.arm_a;
  if (tether.b < 0) {
    ends.arm_b.setZero();
    ends.b = tether.anchor;
  } else {
    const BodyState& b = island.bodies[at(tether.b)];
    ends.arm_b = b.rotation * tether.anchor;
    ends.b = b.position + ends.arm_b;
  }
  return ends;
}

double span_of(const Island& island, const Tether& tether) {
  const Ends ends = ends_of(island, tether);
  return (ends.b - ends.a).norm();
}

bool is_joint(const Tether& tether) { return tether.length <= 0; }

std::vector<Row> rows_of(const Island& island) {
  std::vector<Row> rows;
  for (std::size_t t = 0; t < island.tethers.size(); ++t) {
    const Tether& tether = island.tethers[t];
    if (!tether.is_taut) continue;
    const Ends ends = ends_of(island, tether);
    if (is_joint(tether)) {
      for (int k = 0; k < 3; ++k) {
        rows.push_back({t, Vector3d::Unit(k), ends.arm_a, ends.arm_b, true});
      }
    } else {
      rows.push_back({t, (ends.b - ends.a).normalized(), ends.arm_a, ends.arm_b, false});
    }
  }
  return rows;
}

/// How fast the ends of a row part (m/s).
double parting_speed(const Island& island, const Row& row) {
  const Tether& tether = island.tethers[row.tether];
  const BodyState& a = island.bodies[at(tether.a)];
  Vector3d velocity = -(a.velocity + a.spin.cross(row.arm_a));
  if (tether.b >= 0) {
    const BodyState& b = island.bodies[at(tether.b)];
    velocity += b.velocity + b.spin.cross(row.arm_b);
  }
  return row.direction.dot(velocity);
}

/// What `impulse` 1 in row `j` takes from the parting speed of row `i` (1/kg).
double coupling(const Island& island, const Row& i, const Row& j) {
  const Tether &s = island.tethers[i.tether], &t = island.tethers[j.tether];
  double sum = 0;
  const auto add = [&](int body_i, const Vector3d& arm_i, int body_j, const Vector3d& arm_j,
                       double sign) {
    if (body_i < 0 || body_i != body_j) return;
    const BodyState& body = island.bodies[at(body_i)];
    sum += sign * (body.inverse_mass * i.direction.dot(j.direction) +
                   arm_i.cross(i.direction).dot(body.inverse_inertia * arm_j.cross(j.direction)));
  };
  add(s.a, i.arm_a, t.a, j.arm_a, 1);
  add(s.b, i.arm_b, t.b, j.arm_b, 1);
  add(s.a, i.arm_a, t.b, j.arm_b, -1);
  add(s.b, i.arm_b, t.a, j.arm_a, -1);
  return sum;
}

/// Solves with the coupling of all rows; lines that hold the same thing twice share the load.
class Coupling {
 public:
  Coupling(const Island& island, const std::vector<Row>& rows) {
    const auto count = static_cast<Eigen::Index>(rows.size());
    Eigen::MatrixXd matrix(count, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index j = i; j < count; ++j) {
        matrix(i, j) = matrix(j, i) =
            coupling(island, rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)]);
      }
    }
    if (count == 0) return;
    solver_.setThreshold(1e-10);
    solver_.compute(matrix);
  }
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const {
    return right.size() == 0 ? right : Eigen::VectorXd(solver_.solve(right));
  }

 private:
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver_;
};

void give(BodyState& body, const Vector3d& arm, const Vector3d& impulse) {
  body.velocity += body.inverse_mass * impulse;
  body.angular_momentum += arm.cross(impulse);
  body.spin = body.inverse_inertia * body.angular_momentum;
}

void pull(Island& island, const std::vector<Row>& rows, const Eigen::VectorXd& impulses) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Row& row = rows[r];
    const Tether& tether = island.tethers[row.tether];
    const Vector3d impulse = impulses[static_cast<Eigen::Index>(r)] * row.direction;
    give(island.bodies[at(tether.a)], row.arm_a, impulse);
    if (tether.b >= 0) give(island.bodies[at(tether.b)], row.arm_b, -impulse);
  }
}

/// The books take what the world gave through the lines that it holds; `island` is at the places
/// where the rows were taken.
void book_impulses(Island& island, const std::vector<Row>& rows, const Eigen::VectorXd& impulses) {
  IslandBooks& books = island.books;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Tether& tether = island.tethers[rows[r].tether];
    if (tether.b >= 0) continue;
    const Vector3d impulse = impulses[static_cast<Eigen::Index>(r)] * rows[r].direction;
    const Vector3d moment = (island.bodies[at(tether.a)].position + rows[r].arm_a).cross(impulse);
    books.impulse += impulse;
    books.angular_impulse += moment;
    books.impulse_size += impulse.norm();
    books.angular_impulse_size += moment.norm();
  }
}

/// The line that pushes hardest becomes slack; false if none pushes.
bool slacken(Island& island, std::vector<Row>& rows, const Eigen::VectorXd& impulses) {
  double least = 0;
  std::size_t weakest = rows.size();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double impulse = impulses[static_cast<Eigen::Index>(r)];
    if (rows[r].may_push || impulse >= least) continue;
    least = impulse;
    weakest = r;
  }
  if (weakest == rows.size()) return false;
  island.tethers[rows[weakest].tether].is_taut = false;
  rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(weakest));
  return true;
}

/// Impulses along all taut lines so that none lengthens.
void stop_parting(Island& island) {
  std::vector<Row> rows = rows_of(island);
  while (!rows.empty()) {
    Eigen::VectorXd speeds(static_cast<Eigen::Index>(rows.size()));
    for (std::size_t r = 0; r < rows.size(); ++r) {
      speeds[static_cast<Eigen::Index>(r)] = parting_speed(island, rows[r]);
    }
    const Eigen::VectorXd impulses = Coupling(island, rows).solve(speeds);
    if (slacken(island, rows, impulses)) continue;
    book_impulses(island, rows, impulses);
    pull(island, rows, impulses);
    return;
  }
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

/// How far a row is from where it should be (m).
double error_of(const Island& island, const Row& row) {
  const Tether& tether = island.tethers[row.tether];
  const Ends ends = ends_of(island, tether);
  if (row.may_push) return row.direction.dot(ends.b - ends.a);
  return (ends.b - ends.a).norm() - tether.length;
}

/// Drifts all free bodies with impulses that leave every taut line at its length.
void drift_held(Island& island, double step) {
  const std::vector<BodyState> start = island.bodies;
  std::vector<Row> rows = rows_of(island);
  for (;;) {
    const auto count = static_cast<Eigen::Index>(rows.size());
    Eigen::VectorXd impulses(count);
    for (Eigen::Index r = 0; r < count; ++r) {
      const Row& row = rows[static_cast<std::size_t>(r)];
      impulses[r] = row.may_push ? 0 : 0.5 * step * island.tethers[row.tether].tension;
    }
    const Coupling held(island, rows);
    double worst_before = std::numeric_limits<double>::infinity();
    for (int i = 0;; ++i) {
      pull(island, rows, impulses);
      for (int b = 0; b < island.num_free; ++b) drift_body(island.bodies[at(b)], step);
      Eigen::VectorXd errors(count);
      double worst = 0;
      for (Eigen::Index r = 0; r < count; ++r) {
        const Row& row = rows[static_cast<std::size_t>(r)];
        errors[r] = error_of(island, row);
        const Tether& tether = island.tethers[row.tether];
        const double scale = std::max(tether.length, island.bodies[at(tether.a)].reach);
        worst = std::max(worst, std::abs(errors[r]) / scale);
      }
      const bool is_rounding = worst <= kRounding && worst > kLeastGain * worst_before;
      if (worst <= kHeld || is_rounding || i == kMostIterations) break;
      worst_before = worst;
      impulses += held.solve(errors) / step;
      island.bodies = start;
    }
    const std::vector<BodyState> end = island.bodies;
    island.bodies = start;
    if (slacken(island, rows, impulses)) continue;
    book_impulses(island, rows, impulses);
    island.bodies = end;
    for (Tether& tether : island.tethers) tether.tension = 0;
    for (Eigen::Index r = 0; r < count; ++r) {
      Tether& tether = island.tethers[rows[static_cast<std::size_t>(r)].tether];
      tether.tension = std::hypot(tether.tension, 2 * impulses[r] / step);
    }
    return;
  }
}

/// By how much (share of its length) the longest of the slack lines is too long.
double excess_of(const Island& island) {
  double excess = -1;
  for (const Tether& tether : island.tethers) {
    if (tether.is_taut) continue;
    excess = std::max(excess, span_of(island, tether) / tether.length - 1);
  }
  return excess;
}

}  // namespace

double tether_step(Island& island, const Vector3d& gravity) {
  double step = std::numeric_limits<double>::infinity();
  for (const Tether& tether : island.tethers) {
    const double span = span_of(island, tether);
    for (const int i : {tether.a, tether.b}) {
      if (i < 0) continue;
      BodyState& body = island.bodies[at(i)];
      const double arm = (i == tether.a ? tether.attach_b : tether.anchor).norm();
      const double lever = std::max(tether.length, arm);
      const double speed = body.velocity.norm();
      // What the line gives at least, and what it gave last.
      const double acceleration =
          std::max(tether.tension * body.inverse_mass,
                   gravity.norm() + (lever > 0 ? speed * speed / lever : 0));
      body.other_acceleration += 2 * acceleration;
      const double spin = body.spin.norm();
      if (spin > 0) step = std::min(step, kTurnOfStep / spin);
      if (!tether.is_taut && span < tether.length) continue;
      const double swing = lever > 0 ? std::sqrt(acceleration / lever) : 0;
      // The body rocks about the point where the line holds it.
      const double turning = body.inverse_inertia_b.cwiseAbs().rowwise().sum().maxCoeff();
      const double rocking =
          is_joint(tether) ? 0 : std::sqrt(acceleration * body.mass * arm * turning);
      if (swing > 0) step = std::min(step, kPhaseOfStep / swing);
      if (rocking > 0) step = std::min(step, kRockingOfStep / rocking);
    }
  }
  return step;
}

void tighten(Island& island) {
  bool snaps = false;
  for (std::size_t t = 0; t < island.tethers.size(); ++t) {
    Tether& tether = island.tethers[t];
    if (tether.is_taut) continue;
    const Ends ends = ends_of(island, tether);
    const double span = (ends.b - ends.a).norm();
    if (span < tether.length * (1 - kFull)) continue;
    const Row row{t, (ends.b - ends.a) / span, ends.arm_a, ends.arm_b, false};
    if (parting_speed(island, row) < 0) continue;
    tether.is_taut = snaps = true;
  }
  if (!snaps) return;
  const double before = kinetic_energy(island);
  stop_parting(island);
  island.books.damping_work += before - kinetic_energy(island);
}

double drift_on_tethers(Island& island, double step, const std::function<void(double)>& kick) {
  const bool has_slack = std::any_of(island.tethers.begin(), island.tethers.end(),
                                     [](const Tether& tether) { return !tether.is_taut; });
  if (!has_slack) {
    kick(step);
    drift_held(island, step);
    return step;
  }
  const Island start = island;
  const auto try_step = [&](double duration) {
    kick(duration);
    drift_held(island, duration);
    return excess_of(island) <= kFull;
  };
  if (try_step(step)) return step;
  double low = 0, high = step;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    island = start;
    if (try_step(middle)) {
      low = middle;
      if (excess_of(island) >= -kFull) return low;
    } else {
      high = middle;
    }
  }
  // A line that is full at the start and pulled apart by another: it gives way by rounding.
  island = start;
  const double least = low > 0 ? low : high;
  try_step(least);
  return least;
}

void hold_velocities(Island& island) { stop_parting(island); }

}  // namespace verisim::dem
