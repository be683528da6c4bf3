// SPDX-License-Identifier: MIT
#include "dem/xpbd_impacts.h"

#include <algorithm>
#include <cmath>

#include "dem/contact_tracking.h"
#include "dem/rotation.h"
#include "dem/xpbd_contacts.h"
#include "dem/xpbd_rows.h"

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

// Passes over the pairs of an island; what still approaches then is stopped by the next substep.
constexpr int kMostRounds = 32;
// Sweeps over the points of one pair, and the change (of the approach speed) that ends them.
constexpr int kMostSweeps = 200;
constexpr double kSettled = 1e-12;
// Halvings of the interval in which the restitution of an impact that would gain energy lies.
constexpr int kHalvings = 30;
constexpr double kRounding = 1e-12;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// One pair's impact: when it began, and how fast the deepest fresh point approached then.
struct Moment {
  double ago = 0;    // s
  double speed = 0;  // m/s
  double pull = 0;   // m/s^2, of gravity, closing
  double depth = 0;  // m, now
};

/// Depth and closing speed now, at constant acceleration, give the moment of contact.
Moment moment_of(const LocalPair& local, const Island& island, const ContactPoint& point,
                 const ContactSettings& settings) {
  const BodyState &a = island.bodies[at(local.a)], &b = island.bodies[at(local.b)];
  Moment moment;
  moment.depth = std::max(point.depth - point.offset, 0.0);
  moment.speed = closing_speed(local, island.bodies, point);
  moment.pull = -point.normal.dot(settings.gravity) * (a.is_free() - b.is_free());
  if (moment.depth <= touch_gap(settings) || moment.speed <= 0) return {0, moment.speed, 0, 0};
  const double then = moment.speed * moment.speed - 2 * moment.pull * moment.depth;
  const double before = std::sqrt(std::max(0.0, then));
  moment.ago = 2 * moment.depth / (moment.speed + before);
  moment.speed = before;
  return moment;
}

/// Would these loads, which took velocities from `before` to `after`, add energy? Rounding aside.
bool gains_energy(const Rows& rows, const std::vector<Rates>& before,
                  const std::vector<Rates>& after) {
  double gained = 0, scale = 0;
  for (const Row& row : rows.rows) {
    const Vector3d first = relative_rate(row, before), last = relative_rate(row, after);
    const Vector3d load = row.load * row.normal + row.grip;
    gained += 0.5 * load.dot(first + last);
    scale += load.norm() * (first.norm() + last.norm());
  }
  return gained > kRounding * scale;
}

class Impacts {
 public:
  Impacts(Island& island, const ContactSettings& settings)
      : island_(island), settings_(settings), moved_(island.bodies.size(), 0) {
    read_velocities(island, before_);
    after_ = before_;
  }

  bool has_moved(const LocalPair& local) const {
    return moved_[at(local.a)] != 0 || moved_[at(local.b)] != 0;
  }

  /// Resolves the impact of one pair that began as `moment` says.
  void hit(int pair, const Moment& moment) {
    LocalPair& local = island_.pairs[at(pair)];
    if (!local.pair.is_touching) {
      island_.time -= moment.ago;
      begin_touching(local, island_, std::max(0.0, moment.speed));
      island_.time += moment.ago;
    }
    collect(pair, moment);
    const double restitution = local.pair.law.restitution;
    solve(restitution, moment);
    if (gains_energy(rows_, before_, after_)) {
      double low = 0, high = restitution;
      for (int n = 0; n < kHalvings; ++n) {
        const double middle = 0.5 * (low + high);
        solve(middle, moment);
        (gains_energy(rows_, before_, after_) ? high : low) = middle;
      }
      solve(low, moment);
    }
    add_momenta(rows_, 1, island_);
    book_loads(rows_, 1, before_, after_, island_);
    for (const int body : {local.a, local.b}) {
      const BodyState& state = island_.bodies[at(body)];
      before_[at(body)] = after_[at(body)] = {state.velocity, state.spin};
      if (state.is_free()) moved_[at(body)] = 1;
    }
    if (moment.ago > 0) catch_up(local, moment);
  }

 private:
  void collect(int pair, const Moment& moment) {
    const LocalPair& local = island_.pairs[at(pair)];
    const BodyState &a = island_.bodies[at(local.a)], &b = island_.bodies[at(local.b)];
    rows_.clear();
    closing_.clear();
    for (std::size_t i = 0; i < local.pair.points.size(); ++i) {
      const ContactPoint& point = local.pair.points[i];
      if (point.depth < -touch_gap(settings_)) continue;
      const Vector3d carried =
          std::holds_alternative<SphereShape>(*a.shape)
              ? a.velocity
              : Vector3d(0.5 * (a.velocity_at(point.place) + b.velocity_at(point.place)));
      add_row(rows_, island_, pair, static_cast<int>(i), point.place - moment.ago * carried,
              a.position - moment.ago * a.velocity, b.position - moment.ago * b.velocity);
      closing_.push_back(-rows_.rows.back().normal.dot(relative_rate(rows_.rows.back(), before_)));
    }
  }

  void solve(double restitution, const Moment& moment) {
    double fastest = 0;
    for (std::size_t i = 0; i < rows_.rows.size(); ++i) {
      Row& row = rows_.rows[i];
      row.load = 0;
      row.grip.setZero();
      const double speed = closing_[i] - moment.pull * moment.ago;
      const bool rebounds = closing_[i] > settings_.restitution_threshold;
      row.target = (rebounds ? restitution * std::max(0.0, speed) : 0) - moment.pull * moment.ago;
      fastest = std::max(fastest, closing_[i]);
    }
    const LocalPair& local = island_.pairs[at(rows_.blocks.front().pair)];
    after_[at(local.a)] = before_[at(local.a)];
    after_[at(local.b)] = before_[at(local.b)];
    for (int n = 0; n < kMostSweeps; ++n) {
      const double pushed = sweep_loads(rows_, island_, 1, after_);
      const double held = sweep_grips(rows_, island_, 1, after_);
      if (std::max(pushed, held) <= kSettled * fastest) break;
    }
  }

  /// Positions take what the impact changed since its moment.
  void catch_up(LocalPair& local, const Moment& moment) {
    IslandBooks& books = island_.books;
    double lifted = 0;
    for (const int body : {local.a, local.b}) {
      BodyState& state = island_.bodies[at(body)];
      if (!state.is_free()) continue;
      Vector3d shift = Vector3d::Zero(), moved_moment = Vector3d::Zero();
      for (const Row& row : rows_.rows) {
        const Vector3d load = (body == row.a ? 1 : -1) * (row.load * row.normal + row.grip);
        shift += moment.ago * state.inverse_mass * load;
        moved_moment += moment.ago * (body == row.a ? row.arm_a : row.arm_b).cross(load);
      }
      state.position += shift;
      state.orientation =
          (rotation_of(state.inverse_inertia * moved_moment) * state.orientation).normalized();
      state.path_low = state.path_low.cwiseMin(state.position);
      state.path_high = state.path_high.cwiseMax(state.position);
      lifted -= state.mass * settings_.gravity.dot(shift);
      lifted -= 0.5 * state.angular_momentum.dot(state.spin);
      refresh(state);
      lifted += 0.5 * state.angular_momentum.dot(state.spin);
      before_[at(body)] = after_[at(body)] = {state.velocity, state.spin};
    }
    books.damping_work -= lifted;
    books.correction_work -= lifted;
    for (ContactPoint& point : local.pair.points) point.depth -= moment.depth;
  }

  Island& island_;
  const ContactSettings& settings_;
  std::vector<char> moved_;  // [bodies] by an impact
  std::vector<Rates> before_, after_;
  std::vector<double> closing_;  // m/s, of each row before
  Rows rows_;
};

}  // namespace

void resolve_impacts(Island& island, const std::vector<FreshPoint>& fresh,
                     const ContactSettings& settings) {
  Impacts impacts(island, settings);
  for (std::size_t i = 0; i < fresh.size();) {
    const int pair = fresh[i].pair;
    const LocalPair& local = island.pairs[at(pair)];
    Moment first;
    for (; i < fresh.size() && fresh[i].pair == pair; ++i) {
      const Moment moment =
          moment_of(local, island, local.pair.points[at(fresh[i].point)], settings);
      if (moment.depth >= first.depth && (moment.depth > first.depth || moment.speed > first.speed))
        first = moment;
    }
    if (fastest_closing(local, island.bodies, settings) > settings.restitution_threshold) {
      impacts.hit(pair, first);
    }
  }
  const int num_pairs = static_cast<int>(island.pairs.size());
  for (int round = 0; round < kMostRounds && island.books.is_finite; ++round) {
    bool has_any = false;
    for (int pair = 0; pair < num_pairs; ++pair) {
      const LocalPair& local = island.pairs[at(pair)];
      if (!impacts.has_moved(local)) continue;
      const double speed = fastest_closing(local, island.bodies, settings);
      if (!(speed > settings.restitution_threshold)) continue;
      impacts.hit(pair, {0, speed, 0, 0});
      has_any = true;
    }
    if (!has_any) break;
  }
}

}  // namespace verisim::dem
