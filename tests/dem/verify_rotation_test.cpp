// SPDX-License-Identifier: MIT
// Free rotation in method dem against the elliptic solution, at the frame of a video.
#include <doctest/doctest.h>

#include <cmath>

#include "verify_worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

namespace {

const Vector3d kMoments(1, 2, 3);

VERISIM_OUT_OF_LINE WorldDefinition rotor_world(const Vector3d& moments, const Vector3d& spin,
                                                double dt) {
  BodyDefinition body = rotor(moments.asDiagonal(), spin);
  body.shape = SphereShape{0.5};
  WorldDefinition definition = free_world({body}, 0.5, 0.5);
  definition.dt = dt;
  return definition;
}

/// Body-frame spin of I = kMoments at time t, started at (e, w, e), by Jacobi's functions (Landau
/// and Lifshitz, Mechanics, section 37). L^2 > 2 E I2 here.
class EllipticSpin {
 public:
  EllipticSpin(double e, double w) {
    const double i1 = 1, i2 = 2, i3 = 3;
    const double energy2 = i1 * e * e + i2 * w * w + i3 * e * e;
    const double l2 = i1 * i1 * e * e + i2 * i2 * w * w + i3 * i3 * e * e;
    a1_ = std::sqrt((energy2 * i3 - l2) / (i1 * (i3 - i1)));
    a2_ = std::sqrt((energy2 * i3 - l2) / (i2 * (i3 - i2)));
    a3_ = std::sqrt((l2 - energy2 * i1) / (i3 * (i3 - i1)));
    rate_ = std::sqrt((i3 - i2) * (l2 - energy2 * i1) / (i1 * i2 * i3));
    // 1 - k^2 written out, because k is almost 1.
    const double below = (i3 - i2) * (l2 - energy2 * i1);
    complement_ = (i3 - i1) * (l2 - energy2 * i2) / below;
    k_ = std::sqrt(1 - complement_);
    start_ = std::ellint_1(k_, std::atan2(w / a2_, e / a1_));
  }
  /// Time between two changes of sign of the middle component (s).
  double flip_interval() const { return 2 * std::comp_ellint_1(k_) / rate_; }
  Vector3d at(double time) const {
    const double phi = amplitude(start_ + rate_ * time);
    const double sn = std::sin(phi), cn = std::cos(phi);
    return {a1_ * cn, a2_ * sn, a3_ * std::sqrt(cn * cn + complement_ * sn * sn)};
  }

 private:
  /// Jacobi's amplitude by descending arithmetic-geometric means (Abramowitz and Stegun 16.4).
  double amplitude(double u) const {
    double a[20], c[20], b = std::sqrt(complement_);
    a[0] = 1;
    c[0] = k_;
    int n = 0;
    while (n < 19 && std::abs(c[n]) > 1e-17) {
      a[n + 1] = 0.5 * (a[n] + b);
      c[n + 1] = 0.5 * (a[n] - b);
      b = std::sqrt(a[n] * b);
      ++n;
    }
    double phi = std::ldexp(a[n] * u, n);
    for (; n > 0; --n) phi = 0.5 * (phi + std::asin(c[n] / a[n] * std::sin(phi)));
    return phi;
  }
  double a1_, a2_, a3_, rate_, complement_, k_, start_;
};

/// Orientation after `time`: classical Runge-Kutta on the quaternion with the exact spin.
Eigen::Quaterniond exact_orientation(const EllipticSpin& spin, double time) {
  const int steps = 20000;
  const double h = time / steps;
  Eigen::Vector4d q(0, 0, 0, 1);  // x, y, z, w
  const auto rate = [](const Eigen::Vector4d& p, const Vector3d& w) {
    const Vector3d v = p.head<3>();
    Eigen::Vector4d r;
    r << 0.5 * (p[3] * w + v.cross(w)), -0.5 * v.dot(w);
    return r;
  };
  Vector3d now = spin.at(0);
  for (int i = 0; i < steps; ++i) {
    const Vector3d middle = spin.at((i + 0.5) * h), next = spin.at((i + 1) * h);
    const Eigen::Vector4d k1 = rate(q, now), k2 = rate(q + 0.5 * h * k1, middle);
    const Eigen::Vector4d k3 = rate(q + 0.5 * h * k2, middle), k4 = rate(q + h * k3, next);
    q = (q + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)).normalized();
    now = next;
  }
  return {q[3], q[0], q[1], q[2]};
}

Vector3d body_spin(const Pose& pose) {
  return pose.orientation.conjugate() * pose.angular_velocity;
}

}  // namespace

TEST_CASE("free_rotation_at_frames_of_a_60th_follows_the_elliptic_solution_for_20_s") {
  const EllipticSpin exact(0.01, 5);
  for (const Steps steps : kBothSteps) {
    WorldDefinition definition = rotor_world(kMoments, {0.01, 5, 0.01}, 1.0 / 60);
    definition.dem.rests_implicitly = steps == Steps::kHybrid;
    const Watched watched = watch(definition, 20);
    const PoseLog& log = watched.result.log;
    double worst_energy = 0, worst_spin = 0, crossing = 0, worst_flip = 0;
    for (std::size_t t = 0; t < log.num_times(); ++t) {
      worst_energy =
          std::max(worst_energy, std::abs(watched.energies[t] / watched.energies[0] - 1));
      const Vector3d spin = body_spin(log.at(t, 0));
      worst_spin = std::max(worst_spin, (spin - exact.at(log.times[t])).norm() / 5);
      const double before = t > 0 ? body_spin(log.at(t - 1, 0)).y() : spin.y();
      if (before * spin.y() >= 0) continue;
      const double time = log.times[t - 1] + before / (before - spin.y()) / 60;
      if (crossing > 0) {
        worst_flip = std::max(worst_flip, std::abs((time - crossing) / exact.flip_interval() - 1));
      }
      crossing = time;
    }
    const double angle = watched.end(0).orientation.angularDistance(exact_orientation(exact, 20)) *
                         180 / std::numbers::pi;
    tell("free rotation: energy, spin, flip interval, degrees", worst_energy, worst_spin,
         worst_flip, angle);
    CHECK(worst_energy < 2e-9);  // measured 5.9e-10
    CHECK(worst_flip < 1e-4);    // measured 1.2e-6
    CHECK(angle < 1e-4);         // measured 5.1e-6 after 20 s
    // In the middle of a flip the spin is early or late by up to 9e-6 s: 2.6e-5 of it, 1.5e-3
    // degrees of orientation. 1e-4 degrees at every time is not met.
    CHECK(worst_spin < 5e-5);
    // Angular momentum is the state: bitwise the same.
    CHECK(watched.world.bodies.angular_momentum[0] == Vector3d(0.01, 10, 0.03));
  }
}

TEST_CASE("flip_intervals_are_those_of_the_elliptic_solution") {
  // 11.4981, 19.5529, 27.5308 s at unit spin (checked against an 8th-order integrator).
  const double exact[3] = {11.4981, 19.5529, 27.5308}, tilts[3] = {0.1, 0.01, 0.001};
  for (int n = 0; n < 3; ++n) {
    CHECK(EllipticSpin(tilts[n], 1).flip_interval() == doctest::Approx(exact[n]).epsilon(1e-5));
  }
}

TEST_CASE("the_spin_of_a_symmetric_top_circles_at_the_closed_form_rate") {
  // Rate (I3 - I1) / I1 w3 in the body frame; 100 turns.
  const Vector3d moments(1, 1, 1.5), spin(0.3, 0, 4);
  const double rate = (moments.z() - moments.x()) / moments.x() * spin.z();
  const double duration = 100 * 2 * std::numbers::pi / rate;
  WorldDefinition definition = rotor_world(moments, spin, duration / 30000);
  const Watched watched = watch(definition, duration);
  const Vector3d end = body_spin(watched.end(0));
  const double phase = std::atan2(end.y(), end.x());
  tell("symmetric top: phase (rad) after 100 turns, spin about the axis", phase, end.z() / 4 - 1);
  CHECK(std::abs(phase) < 1e-5);            // measured 1.3e-6 rad = 2e-9 of the way
  CHECK(std::abs(end.z() / 4 - 1) < 1e-9);  // measured 1.4e-11
}
