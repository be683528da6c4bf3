// SPDX-License-Identifier: MIT
#include "dem/restitution.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem/bisect.h"

namespace verisim::dem {
namespace {

constexpr double kGrowth = 1.1;  // of the search for the root

}  // namespace

double hunt_crossley_factor(double restitution) {
  const double e = std::clamp(restitution, kLeastRestitution, 1.0);
  if (e >= 1) return 0;
  // Below the root the left side grows faster than the right one, near 1/e it is infinite; the
  // trivial root 0 is avoided because the difference is negative between it and the root.
  return bisect(1e-12, 1 / e, [&](double d) {
    const double rest = 1 - e * d;
    return rest <= 0 || std::log((1 + d) / rest) > d * (1 + e);
  });
}

double impact_step(int steps) { return 2 * std::sin(std::numbers::pi / (2 * steps)); }

double discrete_restitution(double factor, int steps) {
  const double h = impact_step(steps);
  double depth = 0, speed = 1, force = 0;  // unit mass, stiffness and approach speed
  for (int i = 0; i < 100 * steps; ++i) {
    const double half = speed - 0.5 * h * force;
    depth += h * half;
    if (depth <= 0) return -half;
    const double damping = depth * factor;
    force = std::max(0.0, depth + damping * half / (1 + 0.5 * h * damping));
    speed = half - 0.5 * h * force;
  }
  return 0;  // never left
}

double calibrated_factor(double restitution, int steps) {
  const double e = std::clamp(restitution, kLeastRestitution, 1.0);
  if (e >= 1) return 0;
  // Far above the root an implicit damper pushes back and the restitution rises again: the first
  // interval that holds the root, or where the restitution is least if it never falls to e.
  double low = 0, high = 1, least = 1;
  for (double now = discrete_restitution(high, steps); now >= e;) {
    if (now >= least) return low;
    least = now;
    low = high;
    high *= kGrowth;
    now = discrete_restitution(high, steps);
  }
  return bisect(low, high, [&](double d) { return discrete_restitution(d, steps) < e; });
}

}  // namespace verisim::dem
