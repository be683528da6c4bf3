// SPDX-License-Identifier: MIT
#include "dem/rest_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dem/contact_tracking.h"
#include "dem/rotation.h"

namespace verisim::dem {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Loaded springs are damped by three steps' worth of their stiffness: what is pressed in comes out
// at depth / (4 h) at the fastest.
constexpr double kNormalSteps = 3;
// A sliding contact has no stiffness along its slip. Near the solution the matrix has none (Newton
// converges); far from it, where who slides where is not found yet, it leaves half of what it would
// have stuck, then half as much after each whole step and more after a short one.
constexpr double kSlidingShare = 0.5, kWholeStep = 0.9, kShortStep = 0.2;
// Residual, as a share of the weights, that counts as near.
constexpr double kNear = 1;
// Where much moves, who slides where is found with friction that gives way at a speed first, as a
// share of the speed that the step changes; then it hardens by this factor per Newton step.
constexpr double kFirstSlip = 0.1, kSlipAgain = 1e-2, kHardening = 0.2, kLongStep = 0.5;
constexpr int kMostNewtonSteps = 40;
// Newton steps without halving the residual after which it counts as solved, if it is this small.
constexpr int kStalled = 4;
constexpr double kFloor = 1e-6;
// How far a solve goes: share of its start that the residual must fall to in a pass, and change of
// the bounds (rms, of all bounds) below which they are settled. Rest is solved out. What moves is
// solved as well as its step is accurate: momentum is exact anyway, and the energy is watched.
struct Accuracy {
  double gain, bound_change;
  int most_passes;
  double slip = 0;  // share of the speed that the step changes
};
constexpr Accuracy kResting{1e-9, 1e-6, 4}, kMoving{5e-4, 5e-2, 3, 2e-2};
// Of the speed that the step changes: least that its solution is measured by.
constexpr double kLeastSeen = 1e-3;
// Enough to see which springs are overloaded.
constexpr Accuracy kRough{0.2, 0.1, 2, 5e-2};
// Residual at the start of a step, as a share of the weights, from where a crowd counts as moving.
constexpr double kCalm = 1e-5;
// And below which it is known well enough who slides where.
constexpr double kStill = 0.1;
// A friction this close to its bound is at it: rounding may leave it just below.
constexpr double kAtBound = 1e-9;
// Block products of a factorisation, per edge, above which gradients are cheaper.
constexpr double kMostFill = 100;
// Residual, as a share of the weights, that counts as solved. Looser ones keep a pile moving.
constexpr double kSolved = 1e-9;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Speed (m/s) from which the load of a row counts whose surfaces meet within the step: Newton's
/// restitution, where the approach is an impact and nothing presses the spring in yet. The step
/// turns the bodies round where they are and not where they meet; what they would fall less for
/// that is taken off. And the spring would count what is left of the gap against the rebound.
double rebound_of(const RestRow& row, const Island& island, double duration,
                  const ContactSettings& settings) {
  const PairLaw& law = row.local->pair.law;
  const double gap = row.point->offset - row.point->depth;
  if (law.restitution < kPlastic || gap < 0 || !is_throng(island)) return 0;
  const double speed = closing_speed(*row.local, island.bodies, *row.point);
  if (speed <= least_impact_speed(settings) || speed * duration <= gap) return 0;
  const double pull = std::abs(row.normal.dot(settings.gravity));  // on one, if the other lies
  const double parting = law.restitution * std::sqrt(speed * speed + 2 * pull * gap);
  const double too_high = gap + gap / speed * parting;
  const double left = parting * parting - 2 * pull * too_high;
  return left > 0 ? std::sqrt(left) + gap / duration : 0;
}

}  // namespace

void RestProblem::set_up(Island& island, double duration, const ContactSettings& settings) {
  island_ = &island;
  h_ = duration;
  gravity_ = settings.gravity.norm();
  const std::size_t n = at(island.num_free);
  start_.resize(n);
  free_.resize(n);
  inertia_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const BodyState& body = island.bodies[i];
    start_[i] << body.velocity, body.spin;
    inertia_[i] = body.rotation * body.inertia_b * body.rotation.transpose();
    const Vector3d pull = settings.gravity + body.inverse_mass * body.outside_force;
    const Vector3d momentum = body.angular_momentum + h_ * body.outside_torque;
    free_[i] << body.velocity + h_ * pull, body.inverse_inertia * momentum;
  }
  rows_.clear();
  for (LocalPair& local : island.pairs) {
    const BodyState& a = island.bodies[at(local.a)];
    const BodyState& b = island.bodies[at(local.b)];
    for (ContactPoint& point : local.pair.points) {
      RestRow row;
      row.local = &local;
      row.point = &point;
      row.a = a.is_free() ? local.a : -1;
      row.b = b.is_free() ? local.b : -1;
      row.normal = point.normal;
      row.arm_a = point.place - a.position;
      row.arm_b = point.place - b.position;
      if (row.a < 0) row.given += a.velocity_at(point.place);
      if (row.b < 0) row.given -= b.velocity_at(point.place);
      row.friction = local.pair.law.friction;
      const double pressed =
          local.pair.stiffness * point.weight * std::max(0.0, point.depth - point.offset);
      row.load = std::min(point.load, pressed);
      row.stretch = turned_into_plane(b.rotation * point.stretch_b, point.normal);
      row.rebound = rebound_of(row, island, h_, settings);
      rows_.push_back(row);
    }
  }
  loops_.set_places(rows_, n, h_);
  loops_.list_edges(matrix_);
  matrix_.diagonal.resize(n);
  matrix_.off.resize(matrix_.edges.size());
  is_first_ = true;
  slip_speed_ = 0;
  cholesky_.start_series();
  is_direct_ = true;  // until the fill of this step says otherwise
  v_ = start_;
  refresh_rows(settings);
}

void RestProblem::refresh_rows(const ContactSettings& settings) {
  for (RestRow& row : rows_) {
    const ContactPair& pair = row.local->pair;
    row.stiffness = pair.stiffness * row.point->weight;
    row.compression = row.point->depth - row.point->offset;
    row.damping = row.compression > 0 ? kNormalSteps * h_ * row.stiffness : 0;
    row.shear = settings.tangential_ratio * row.stiffness;
    row.bound = row.friction * row.load;
  }
  loops_.set_springs(rows_);
  loops_.set_bounds(rows_, slip_speed_);
}

void RestProblem::apply_mass(std::vector<Vector6>& v) const {
  for (std::size_t i = 0; i < v.size(); ++i) {
    v[i].head<3>() *= island_->bodies[i].mass;
    v[i].tail<3>() = inertia_[i] * v[i].tail<3>();
  }
}

/// Gradient of the objective; loads and tangential forces of the loops are set.
void RestProblem::evaluate(const std::vector<Vector6>& v, std::vector<Vector6>& gradient) {
  gradient.resize(v.size());
  for (std::size_t i = 0; i < v.size(); ++i) gradient[i] = v[i] - free_[i];
  apply_mass(gradient);
  loops_.evaluate(v, gradient);
}

/// The matrix of second derivatives at the last evaluation, ready to solve with.
void RestProblem::assemble(double sliding_share) {
  for (std::size_t i = 0; i < matrix_.diagonal.size(); ++i) {
    matrix_.diagonal[i].setZero();
    matrix_.diagonal[i].diagonal().head<3>().setConstant(island_->bodies[i].mass);
    matrix_.diagonal[i].bottomRightCorner<3, 3>() = inertia_[i];
  }
  loops_.add_stiffness(sliding_share, matrix_);
  if (!is_direct_) return;
  cholesky_.analyse(matrix_);
  const double num_blocks = static_cast<double>(cholesky_.num_edges() + matrix_.diagonal.size());
  is_direct_ = cholesky_.num_block_products() < kMostFill * num_blocks;
  if (is_direct_) cholesky_.factorise(matrix_);
}

void RestProblem::solve_linear(const std::vector<Vector6>& b, std::vector<Vector6>& x,
                               double tolerance) {
  if (is_direct_) {
    cholesky_.solve(b, x);
  } else {
    gradients_.solve(matrix_, b, tolerance, 200, x);
  }
}

/// Where the objective is least along `direction` from the last evaluation, whose gradient this is:
/// false position on its slope.
double RestProblem::line_search(const std::vector<Vector6>& gradient,
                                const std::vector<Vector6>& direction) {
  double at_start = 0;
  for (std::size_t i = 0; i < gradient.size(); ++i) at_start += gradient[i].dot(direction[i]);
  if (!(at_start < 0)) return 0;
  weighted_ = direction;
  apply_mass(weighted_);
  double curvature = 0, slope_of_mass = 0;
  for (std::size_t i = 0; i < direction.size(); ++i) {
    curvature += direction[i].dot(weighted_[i]);
    slope_of_mass += (v_[i] - free_[i]).dot(weighted_[i]);
  }
  loops_.set_direction(direction);
  const auto slope = [&](double t) { return slope_of_mass + t * curvature + loops_.slope(t); };
  double low = 0, low_slope = at_start, high = 1, high_slope = slope(1);
  if (std::abs(high_slope) <= 0.2 * -at_start) return 1;
  while (high_slope < 0 && high < 8) {
    low = high;
    low_slope = high_slope;
    high *= 2;
    high_slope = slope(high);
  }
  if (high_slope < 0) return high;
  double t = high;
  for (int i = 0; i < 12; ++i) {
    t = low + (high - low) * low_slope / (low_slope - high_slope);
    if (i % 3 == 2) t = 0.5 * (low + high);
    const double here = slope(t);
    if (std::abs(here) <= 0.05 * -at_start) break;
    if (here < 0) {
      low = t;
      low_slope = here;
    } else {
      high = t;
      high_slope = here;
    }
  }
  return t;
}

/// Lets what sticks slip by `speed` (m/s).
void RestProblem::soften(double speed) {
  slip_speed_ = speed;
  loops_.set_bounds(rows_, slip_speed_);
}

/// Rms over bodies of the gradient against the impulse of a body's weight.
double RestProblem::scaled_residual(const std::vector<Vector6>& gradient) const {
  double sum = 0;
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    const BodyState& body = island_->bodies[i];
    const double impulse = body.mass * gravity_ * h_;
    sum += gradient[i].head<3>().squaredNorm() / (impulse * impulse) +
           gradient[i].tail<3>().squaredNorm() / (impulse * impulse * body.size * body.size);
  }
  return std::sqrt(sum / static_cast<double>(gradient.size()));
}

/// Rms over bodies of the closing speed (m/s), after free flight, where they meet something.
double RestProblem::expected_speed_change() const {
  std::vector<double> fastest(free_.size(), 0);
  for (const RestRow& row : rows_) {
    const double closing = -row.normal.dot(relative_velocity(row, free_));
    if (row.compression + h_ * closing <= 0) continue;
    if (row.a >= 0) fastest[at(row.a)] = std::max(fastest[at(row.a)], closing);
    if (row.b >= 0) fastest[at(row.b)] = std::max(fastest[at(row.b)], closing);
  }
  double sum = 0;
  for (const double speed : fastest) sum += speed * speed;
  return std::sqrt(sum / static_cast<double>(fastest.size()));
}

/// Rms over bodies of their speed (m/s) at the start of the step.
double RestProblem::start_speed() const {
  double sum = 0;
  for (const Vector6& v : start_) sum += v.head<3>().squaredNorm();
  return std::sqrt(sum / static_cast<double>(start_.size()));
}

RestProblem::Outcome RestProblem::solve(bool is_rough) {
  Outcome outcome;
  std::vector<Vector6>&gradient = gradient_, &direction = direction_;
  Accuracy accuracy = is_rough ? kRough : kResting;
  for (int pass = 0; pass < accuracy.most_passes; ++pass) {
    evaluate(v_, gradient);
    double residual = scaled_residual(gradient);
    if (is_first_) {
      is_moving_ = residual > kCalm && is_crowd(*island_);
      // Of stiff springs that close fast the residual says more than how much will change.
      if (is_moving_) speed_change_ = std::min(residual * gravity_ * h_, expected_speed_change());
    }
    if (!is_rough && is_moving_) accuracy = kMoving;
    // What all but lies must neither creep nor gain energy for what moves a little.
    const double seen_speed =
        is_rough ? speed_change_
                 : std::clamp(start_speed(), kLeastSeen * speed_change_, speed_change_);
    const double last_slip = is_moving_ ? accuracy.slip * seen_speed : 0;
    if (is_moving_ && pass == 0 && residual > kStill) {
      soften((is_first_ ? kFirstSlip : kSlipAgain) * speed_change_);
      evaluate(v_, gradient);
      residual = scaled_residual(gradient);
    }
    is_first_ = false;
    const double start = residual;
    const double enough =
        std::max(kSolved, accuracy.gain * (is_moving_ ? seen_speed / (gravity_ * h_) : start));
    double share = residual < kNear ? 1 : kSlidingShare;
    outcome.converged =
        slip_speed_ <= last_slip && residual <= (pass == 0 && !is_moving_ ? kSolved : enough);
    double best = residual;
    best_ = v_;
    int stalled = 0;
    for (int i = 0; i < kMostNewtonSteps && !outcome.converged; ++i) {
      assemble(share);
      solve_linear(gradient, direction, 1e-2);
      for (Vector6& d : direction) d = -d;
      const double t = line_search(gradient, direction);
      if (t >= kWholeStep) share = 0.5 * (1 + share);
      if (t < kShortStep) share *= 0.5;
      for (std::size_t k = 0; k < v_.size(); ++k) v_[k] += t * direction[k];
      evaluate(v_, gradient);
      ++outcome.newton_steps;
      residual = scaled_residual(gradient);
      if (slip_speed_ > last_slip && (t >= kLongStep || residual <= enough)) {
        loops_.take_forces(rows_);
        for (RestRow& row : rows_) row.bound = row.friction * row.load;
        soften(std::max(last_slip, kHardening * slip_speed_));
        evaluate(v_, gradient);
        residual = scaled_residual(gradient);
        best = std::numeric_limits<double>::infinity();
      }
      outcome.converged = slip_speed_ <= last_slip && residual <= enough;
      stalled = residual > 0.5 * best ? stalled + 1 : 0;
      if (residual < best) {
        best = residual;
        best_ = v_;
      }
      // Rounding sets a floor under heavy loads on light bodies.
      if (stalled < kStalled || best > kFloor * std::max(1.0, start)) continue;
      outcome.converged = true;
    }
    if (residual > best) {
      v_ = best_;
      evaluate(v_, gradient);
    }
    loops_.take_forces(rows_);
    // Bounds matter where they hold; a contact that sticks within both is what it was.
    double change = 0, whole = 0;
    for (const RestRow& row : rows_) {
      const double bound = row.friction * row.load;
      const bool sticks = row.tangential.norm() < (1 - kAtBound) * std::min(row.bound, bound);
      if (!sticks) change += (bound - row.bound) * (bound - row.bound);
      whole += bound * bound;
    }
    const bool is_settled = change <= accuracy.bound_change * accuracy.bound_change * whole;
    if (is_settled || pass + 1 == accuracy.most_passes)
      break;  // the bounds stay those of the solution
    for (RestRow& row : rows_) row.bound = row.friction * row.load;
    loops_.set_bounds(rows_, slip_speed_);
  }
  // The loads of the solution, put on the bodies exactly: momentum is kept to rounding.
  evaluate(v_, gradient);
  loops_.take_forces(rows_);
  end_ = free_;
  for (const RestRow& row : rows_) {
    const Vector3d force = h_ * (row.load * row.normal + row.tangential);
    const auto give = [&](int body, const Vector3d& arm, double sign) {
      if (body < 0) return;
      const BodyState& state = island_->bodies[at(body)];
      end_[at(body)].head<3>() += (sign * state.inverse_mass) * force;
      end_[at(body)].tail<3>() += sign * (state.inverse_inertia * arm.cross(force));
    };
    give(row.a, row.arm_a, 1);
    give(row.b, row.arm_b, -1);
  }
  return outcome;
}

void RestProblem::project(std::vector<Vector6>& c) {
  assemble(1);
  weighted_ = c;
  apply_mass(weighted_);
  solve_linear(weighted_, c, 1e-6);
}

}  // namespace verisim::dem
