// SPDX-License-Identifier: MIT
#include "dem/xpbd_rows.h"

#include <algorithm>
#include <cmath>

#include "dem/rotation.h"

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

Vector3d across(const Vector3d& v, const Vector3d& normal) { return v - normal.dot(v) * normal; }

/// Velocity (per N s) that a load at the end of `arm` gives the body there: 1/m - [arm] I^-1 [arm].
Eigen::Matrix3d mobility(const BodyState& body, const Vector3d& arm) {
  const Eigen::Matrix3d cross = cross_matrix(arm);
  return body.inverse_mass * Eigen::Matrix3d::Identity() - cross * body.inverse_inertia * cross;
}

double push(Row& row, const Island& island, std::vector<Rates>& rates) {
  Rates &a = rates[at(row.a)], &b = rates[at(row.b)];
  const double rate =
      row.normal.dot(a.linear - b.linear) + row.lever_a.dot(a.angular) - row.lever_b.dot(b.angular);
  const double load = std::max(0.0, row.load + (row.target - rate) / row.inverse_mass);
  const double change = load - row.load;
  if (change == 0) return 0;
  row.load = load;
  a.linear += (change * island.bodies[at(row.a)].inverse_mass) * row.normal;
  b.linear -= (change * island.bodies[at(row.b)].inverse_mass) * row.normal;
  a.angular += change * row.turn_a;
  b.angular -= change * row.turn_b;
  return std::abs(change) * row.inverse_mass;
}

double hold(Row& row, const Island& island, std::vector<Rates>& rates) {
  if (row.friction * row.load == 0 && row.grip.isZero(0)) {
    row.slides = row.load > 0;
    return 0;
  }
  const Vector3d slip = across(row.slip + relative_rate(row, rates), row.normal);
  const double size = slip.norm();
  Vector3d grip = row.grip;
  if (size > 0) grip -= (size * size / slip.dot(row.inverse_masses * slip)) * slip;
  const double limit = row.friction * row.load, wanted = grip.norm();
  row.slides = wanted > limit;
  if (row.slides) grip *= limit / wanted;
  const Vector3d change = grip - row.grip;
  if (change.isZero(0)) return 0;
  row.grip = grip;
  apply_load(row, change, island, rates);
  return change.norm() * row.inverse_mass;
}

template <class Change>
double sweep(Rows& rows, int inner, const Change& change) {
  double largest = 0;
  for (const RowBlock& block : rows.blocks) {
    const int times = block.end - block.first > 1 ? inner : 1;
    for (int n = 0; n < times; ++n) {
      for (int i = block.first; i < block.end; ++i) {
        largest = std::max(largest, change(rows.rows[at(i)]));
      }
    }
  }
  return largest;
}

}  // namespace

Row& add_row(Rows& rows, const Island& island, int pair, int point, const Vector3d& place,
             const Vector3d& start_a, const Vector3d& start_b) {
  const LocalPair& local = island.pairs[at(pair)];
  const int index = static_cast<int>(rows.rows.size());
  Row row;
  row.pair = pair;
  row.point = point;
  row.a = local.a;
  row.b = local.b;
  row.place = place;
  row.normal = local.pair.points[at(point)].normal;
  row.arm_a = place - start_a;
  row.arm_b = place - start_b;
  const BodyState &a = island.bodies[at(row.a)], &b = island.bodies[at(row.b)];
  row.lever_a = row.arm_a.cross(row.normal);
  row.lever_b = row.arm_b.cross(row.normal);
  row.turn_a = a.inverse_inertia * row.lever_a;
  row.turn_b = b.inverse_inertia * row.lever_b;
  row.inverse_mass =
      a.inverse_mass + b.inverse_mass + row.lever_a.dot(row.turn_a) + row.lever_b.dot(row.turn_b);
  row.friction = local.pair.law.friction;
  if (row.friction > 0) row.inverse_masses = mobility(a, row.arm_a) + mobility(b, row.arm_b);
  rows.rows.push_back(row);
  if (rows.blocks.empty() || rows.blocks.back().pair != pair) {
    rows.blocks.push_back({pair, index, index});
  }
  rows.blocks.back().end = index + 1;
  return rows.rows.back();
}

Vector3d relative_rate(const Row& row, const std::vector<Rates>& rates) {
  const Rates &a = rates[at(row.a)], &b = rates[at(row.b)];
  return a.linear + a.angular.cross(row.arm_a) - b.linear - b.angular.cross(row.arm_b);
}

void apply_load(const Row& row, const Vector3d& load, const Island& island,
                std::vector<Rates>& rates) {
  const BodyState &a = island.bodies[at(row.a)], &b = island.bodies[at(row.b)];
  rates[at(row.a)].linear += a.inverse_mass * load;
  rates[at(row.b)].linear -= b.inverse_mass * load;
  rates[at(row.a)].angular += a.inverse_inertia * row.arm_a.cross(load);
  rates[at(row.b)].angular -= b.inverse_inertia * row.arm_b.cross(load);
}

double sweep_loads(Rows& rows, const Island& island, int inner, std::vector<Rates>& rates) {
  return sweep(rows, inner, [&](Row& row) { return push(row, island, rates); });
}

double sweep_grips(Rows& rows, const Island& island, int inner, std::vector<Rates>& rates) {
  return sweep(rows, inner, [&](Row& row) { return hold(row, island, rates); });
}

void read_velocities(const Island& island, std::vector<Rates>& rates) {
  rates.resize(island.bodies.size());
  for (std::size_t i = 0; i < rates.size(); ++i) {
    rates[i] = {island.bodies[i].velocity, island.bodies[i].spin};
  }
}

void add_momenta(const Rows& rows, double share, Island& island) {
  for (const Row& row : rows.rows) {
    const Vector3d impulse = share * (row.load * row.normal + row.grip);
    BodyState &a = island.bodies[at(row.a)], &b = island.bodies[at(row.b)];
    if (a.is_free()) {
      a.velocity += a.inverse_mass * impulse;
      a.angular_momentum += row.arm_a.cross(impulse);
    }
    if (b.is_free()) {
      b.velocity -= b.inverse_mass * impulse;
      b.angular_momentum -= row.arm_b.cross(impulse);
    }
  }
  for (int i = 0; i < island.num_free; ++i) {
    BodyState& body = island.bodies[at(i)];
    body.spin = body.inverse_inertia * body.angular_momentum;
    check_finite(body, island.books);
  }
}

void book_loads(const Rows& rows, double share, const std::vector<Rates>& before,
                const std::vector<Rates>& after, Island& island) {
  IslandBooks& books = island.books;
  for (const Row& row : rows.rows) {
    const Vector3d mean = 0.5 * (relative_rate(row, before) + relative_rate(row, after));
    const Vector3d pushed = (share * row.load) * row.normal, held = share * row.grip;
    books.damping_work -= pushed.dot(mean);
    books.friction_work -= held.dot(mean);
    const Vector3d impulse = pushed + held;
    books.impulse_size += impulse.norm();
    books.angular_impulse_size += row.place.cross(impulse).norm();
    const BodyState &a = island.bodies[at(row.a)], &b = island.bodies[at(row.b)];
    if (a.is_free() && b.is_free()) continue;
    // What is held or moved from outside passes on what the contact takes.
    const double sign = a.is_free() ? 1 : -1;
    const BodyState& held_one = a.is_free() ? b : a;
    books.outside_work += sign * impulse.dot(held_one.velocity_at(row.place));
    books.impulse += sign * impulse;
    books.angular_impulse += sign * row.place.cross(impulse);
  }
}

}  // namespace verisim::dem
