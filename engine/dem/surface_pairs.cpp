// SPDX-License-Identifier: MIT
// Which bodies may meet within a frame: bounds of their paths, and the pairs whose bounds overlap.
#include <algorithm>
#include <limits>

#include "dem/normal_law.h"
#include "dem/surface_contact.h"
#include "dem/surface_contacts.h"

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Half extents of a body along the world's axes (m).
Vector3d extents_of(const BodyState& body) {
  if (const auto* box = std::get_if<BoxShape>(body.shape)) {
    return body.rotation.cwiseAbs() * box->half;
  }
  return Vector3d::Constant(body.reach);
}

}  // namespace

SurfaceContacts::Bounds SurfaceContacts::bounds_over(const BodyState& body, double duration) const {
  const double infinity = std::numeric_limits<double>::infinity();
  if (std::holds_alternative<PlaneShape>(*body.shape)) {
    return {Vector3d::Constant(-infinity), Vector3d::Constant(infinity)};
  }
  const double turn = body.spin.norm() * duration;
  const Vector3d extents = extents_of(body).cwiseMin(Vector3d::Constant(body.reach)) +
                           Vector3d::Constant(std::min(turn, 2.0) * body.reach);
  const Vector3d fall =
      body.is_free() ? Vector3d(0.5 * duration * duration * settings_.gravity) : Vector3d::Zero();
  const Vector3d end = body.position + duration * body.velocity + fall;
  // What is slower than a fall of this duration lies on something.
  const double way = duration * body.velocity.norm();
  const double margin = 0.25 * way + std::min(fall.norm(), 0.5 * way) + 2 * chosen_.max_penetration;
  const Vector3d all =
      extents.cwiseMin(Vector3d::Constant(body.reach)) + Vector3d::Constant(margin);
  return {body.position.cwiseMin(end) - all, body.position.cwiseMax(end) + all};
}

PairLaw SurfaceContacts::law_of(int a, int b) const {
  const std::size_t k = materials_.at(material_[at(a)], material_[at(b)]);
  PairLaw law;
  law.restitution = materials_.restitution[k];
  law.friction = materials_.friction[k];
  const auto* ball_a = std::get_if<SphereShape>(&shapes_[at(a)]);
  const auto* ball_b = std::get_if<SphereShape>(&shapes_[at(b)]);
  if (ball_a == nullptr && ball_b == nullptr) return law;
  law.radius = 1 / ((ball_a != nullptr ? 1 / ball_a->radius : 0) +
                    (ball_b != nullptr ? 1 / ball_b->radius : 0));
  if (!materials_.rolling_friction.empty()) law.rolling_friction = materials_.rolling_friction[k];
  if (settings_.contact_law == NormalLaw::kHertzMindlin) {
    const auto elastic = [&](int body) {
      const std::size_t material = at(material_[at(body)]);
      return Elastic{materials_.young_modulus[material], materials_.poisson_ratio[material]};
    };
    set_hertz(law, elastic(a), elastic(b));
  }
  return law;
}

/// Sets pairs_ to all pairs whose bounds overlap, known ones with their points.
void SurfaceContacts::add_pairs() {
  const int count = static_cast<int>(bodies_.size());
  std::vector<std::uint64_t>& keys = scratch_.keys;
  keys.clear();
  const auto add = [&](int i, int j) {
    const BodyState &x = bodies_[at(i)], &y = bodies_[at(j)];
    if (!x.is_free() && !y.is_free()) return;
    const bool swap =
        !is_in_order(*x.shape, *y.shape) || (is_in_order(*y.shape, *x.shape) && j < i);
    ContactPair pair;
    pair.a = swap ? j : i;
    pair.b = swap ? i : j;
    keys.push_back(pair.key());
  };
  const auto overlap = [&](int i, int j) {
    const Bounds &x = bounds_[at(i)], &y = bounds_[at(j)];
    return (x.low.array() <= y.high.array()).all() && (y.low.array() <= x.high.array()).all();
  };
  std::vector<int>& order = scratch_.order;  // of the bounded, along the axis of the widest spread
  order.clear();
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (int i = 0; i < count; ++i) {
    if (std::holds_alternative<PlaneShape>(*bodies_[at(i)].shape)) continue;
    order.push_back(i);
    low = low.cwiseMin(bodies_[at(i)].position);
    high = high.cwiseMax(bodies_[at(i)].position);
  }
  int axis = 0;
  if (!order.empty()) (high - low).maxCoeff(&axis);
  std::sort(order.begin(), order.end(), [&](int i, int j) {
    const double x = bounds_[at(i)].low[axis], y = bounds_[at(j)].low[axis];
    return x != y ? x < y : i < j;
  });
  for (std::size_t s = 0; s < order.size(); ++s) {
    for (std::size_t t = s + 1; t < order.size(); ++t) {
      if (bounds_[at(order[t])].low[axis] > bounds_[at(order[s])].high[axis]) break;
      if (overlap(order[s], order[t])) add(order[s], order[t]);
    }
  }
  for (int p = 0; p < count; ++p) {
    const BodyState& plane = bodies_[at(p)];
    if (!std::holds_alternative<PlaneShape>(*plane.shape)) continue;
    const Vector3d up = plane.rotation.col(2);
    for (const int i : order) {
      const Bounds& bounds = bounds_[at(i)];
      const Vector3d lowest = (up.array() > 0).select(bounds.low, bounds.high);
      if (up.dot(lowest - plane.position) <= 0) add(i, p);
    }
  }
  std::sort(keys.begin(), keys.end());
  const auto has_key = [](const ContactPair& pair, std::uint64_t key) { return pair.key() == key; };
  if (std::equal(pairs_.begin(), pairs_.end(), keys.begin(), keys.end(), has_key)) return;
  std::vector<ContactPair> pairs;
  pairs.reserve(keys.size());
  auto known = pairs_.begin();
  for (const std::uint64_t key : keys) {
    while (known != pairs_.end() && known->key() < key) ++known;
    if (known != pairs_.end() && known->key() == key) {
      pairs.push_back(std::move(*known));
      continue;
    }
    ContactPair pair;
    pair.a = static_cast<int>(key >> 32);
    pair.b = static_cast<int>(key & 0xffffffffu);
    pair.law = law_of(pair.a, pair.b);
    pairs.push_back(std::move(pair));
  }
  pairs_ = std::move(pairs);
}

/// What meets a body that left its bounds may go on along the same way, and so may what that meets
/// (a row of balls).
void SurfaceContacts::pass_on_pushes() {
  const auto pass = [&](int from, int to) {
    const Vector3d& push = scratch_.pushes[at(from)];
    if (push.isZero(0) || !scratch_.pushes[at(to)].isZero(0) || !bodies_[at(to)].is_free()) {
      return false;
    }
    scratch_.pushes[at(to)] = push;
    bounds_[at(to)].low += push.cwiseMin(0);
    bounds_[at(to)].high += push.cwiseMax(0);
    return true;
  };
  for (bool is_any = true; is_any;) {
    is_any = false;
    for (const ContactPair& pair : pairs_) {
      is_any = pass(pair.a, pair.b) || pass(pair.b, pair.a) || is_any;
    }
    if (is_any) add_pairs();
  }
}

/// Widens the bounds of bodies that left theirs; true if that makes a pair that was not looked at.
bool SurfaceContacts::add_missed_pairs() {
  bool has_any_left = false;
  const auto widen = [&](const BodyState& body, bool is_pushing) {
    Bounds& bounds = bounds_[at(body.index)];
    const Vector3d extents = extents_of(body).cwiseMax(extents_of(bodies_[at(body.index)]));
    const Vector3d low = body.path_low - extents, high = body.path_high + extents;
    if ((low.array() >= bounds.low.array()).all() && (high.array() <= bounds.high.array()).all()) {
      return;
    }
    const double margin = 0.1 * (high - low).norm();
    bounds.low = bounds.low.cwiseMin(low - Vector3d::Constant(margin));
    bounds.high = bounds.high.cwiseMax(high + Vector3d::Constant(margin));
    if (!has_any_left) scratch_.pushes.assign(bodies_.size(), Vector3d::Zero());
    has_any_left = true;
    if (!is_pushing) return;
    scratch_.pushes[at(body.index)] = body.position - bodies_[at(body.index)].position;
  };
  for (const Island& island : islands_) {
    for (int i = 0; i < island.num_free; ++i) widen(island.bodies[at(i)], !is_throng(island));
  }
  if (!has_any_left) return false;
  const std::size_t before = pairs_.size();
  add_pairs();
  if (pairs_.size() == before) return false;
  pass_on_pushes();
  return true;
}

}  // namespace verisim::dem
