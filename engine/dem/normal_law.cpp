// SPDX-License-Identifier: MIT
#include "dem/normal_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem/bisect.h"
#include "dem/restitution.h"

namespace verisim::dem {
namespace {

// Elastic contact time of Hertz's law in units of depth over approach speed: the integral
// 2 int_0^1 dx / sqrt(1 - x^(5/2)).
constexpr double kHertzTime = 2.94327;

/// Restitution of the clamped linear spring and dashpot in continuous time.
double linear_restitution(double zeta) {
  if (zeta == 1) return std::exp(-2.0);
  if (zeta < 1) {
    const double w = std::sqrt(1 - zeta * zeta);
    return std::exp(-zeta / w * (std::numbers::pi - std::atan2(2 * zeta * w, w * w - zeta * zeta)));
  }
  const double w = std::sqrt(zeta * zeta - 1);
  return std::exp(-zeta / w * std::log((zeta + w) / (zeta - w)));
}

}  // namespace

NormalSpring normal_spring(const LocalPair& local, double weight, double total_weight,
                           double compression, double inverse_mass, NormalLaw law) {
  const ContactPair& pair = local.pair;
  NormalSpring spring;
  if (law == NormalLaw::kHertzMindlin) {
    const double hertz = pair.law.hertz, root = std::sqrt(compression);
    spring.force = hertz * compression * root;
    spring.energy = 0.4 * spring.force * compression;
    spring.stiffness = 1.5 * hertz * root;
    const double damping = local.factor * std::sqrt(hertz / inverse_mass) * std::sqrt(root);
    spring.relaxation = damping / spring.stiffness;
    return spring;
  }
  const double k = pair.stiffness * weight;
  spring.force = k * compression;
  spring.energy = 0.5 * k * compression * compression;
  spring.stiffness = k;
  if (law == NormalLaw::kLinear) {
    spring.relaxation = 2 * local.factor / std::sqrt(pair.stiffness * total_weight * inverse_mass);
  } else if (pair.approach_speed > 0) {
    spring.relaxation = local.factor / pair.approach_speed * compression;
  }
  return spring;
}

double hertz_depth(double hertz, double mass, double speed) {
  return std::pow(1.25 * mass * speed * speed / hertz, 0.4);
}

double hertz_step_stiffness(const PairLaw& law, double mass, double speed, double depth) {
  const double deepest = hertz_depth(law.hertz, mass, speed);
  if (!(speed > 0) || depth > deepest) return 1.5 * law.hertz * std::sqrt(std::max(0.0, depth));
  const double frequency = std::numbers::pi * speed / (kHertzTime * deepest);
  return mass * frequency * frequency;
}

double discrete_restitution(NormalLaw law, double factor, int steps) {
  if (law == NormalLaw::kHuntCrossley) return discrete_restitution(factor, steps);
  // Unit mass, stiffness and approach speed.
  const bool is_hertz = law == NormalLaw::kHertzMindlin;
  const double time = is_hertz ? kHertzTime * hertz_depth(1, 1, 1) : std::numbers::pi;
  const double h = time / std::numbers::pi * impact_step(steps);
  double depth = 0, speed = 1, force = 0;
  for (int i = 0; i < 100 * steps; ++i) {
    const double half = speed - 0.5 * h * force;
    depth += h * half;
    if (depth <= 0) return -half;
    const double damping = is_hertz ? factor * std::pow(depth, 0.25) : 2 * factor;
    const double elastic = is_hertz ? depth * std::sqrt(depth) : depth;
    force = std::max(0.0, elastic + damping * half / (1 + 0.5 * h * damping));
    speed = half - 0.5 * h * force;
  }
  return 0;  // never left
}

double damping_factor(NormalLaw law, double restitution, int steps) {
  if (law == NormalLaw::kHuntCrossley) return calibrated_factor(restitution, steps);
  const double e = std::clamp(restitution, kLeastRestitution, 1.0);
  if (e >= 1) return 0;
  // Far above the root an implicit damper pushes back: the discrete restitution rises again.
  const double high = 4 * linear_damping_ratio(e);
  return bisect(0, high, [&](double f) { return discrete_restitution(law, f, steps) < e; });
}

double linear_damping_ratio(double restitution) {
  return bisect(0, 1e3, [&](double zeta) { return linear_restitution(zeta) < restitution; });
}

void set_hertz(PairLaw& law, const Elastic& a, const Elastic& b) {
  const auto plane_strain = [](const Elastic& m) {
    return (1 - m.poisson_ratio * m.poisson_ratio) / m.young_modulus;
  };
  // 1 / G* = sum of (2 - nu) / G, G = E / (2 (1 + nu)).
  const auto shear = [](const Elastic& m) {
    return (2 - m.poisson_ratio) * 2 * (1 + m.poisson_ratio) / m.young_modulus;
  };
  const double modulus = 1 / (plane_strain(a) + plane_strain(b));
  law.hertz = 4.0 / 3 * modulus * std::sqrt(law.radius);
  // 8 G* sqrt(R* x) over 2 E* sqrt(R* x).
  law.mindlin = 4 / (shear(a) + shear(b)) / modulus;
}

}  // namespace verisim::dem
