// SPDX-License-Identifier: MIT
#include "dem/tangential_law.h"

#include <algorithm>
#include <cmath>

#include "dem/contact_tracking.h"

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

// Damping of the rolling spring, of critical (Ai et al. 2011).
constexpr double kRollingDamping = 0.3;

/// Inverse of the mass (1/kg) that two bodies present at a place to a push along `direction`.
double inverse_mass_across(const BodyState& a, const BodyState& b, const Vector3d& place,
                           const Vector3d& direction) {
  const auto of = [&](const BodyState& body) {
    if (!body.is_free()) return 0.0;
    const Vector3d turn = (place - body.position).cross(direction);
    return body.inverse_mass + turn.dot(body.inverse_inertia * turn);
  };
  return of(a) + of(b);
}

/// Friction that leaves no sliding after the step, beside a spring that holds what stands still.
Vector3d rigid_stick(ContactPoint& point, const BodyState& a, const BodyState& b, const Grip& grip,
                     double shear, double limit, const Vector3d& stretch, Vector3d& kept) {
  const Vector3d trial = stretch + grip.drift * grip.sliding;
  const double speed = grip.sliding.norm();
  double viscous = 0;
  if (speed > 0 && grip.drift > 0) {
    viscous = 1 / (grip.drift * grip.num_points *
                   inverse_mass_across(a, b, point.place, grip.sliding / speed));
  }
  Vector3d friction = -shear * trial - viscous * grip.sliding;
  kept = trial;
  const double size = friction.norm();
  if (size > limit) {
    point.has_slid = true;
    friction *= limit / size;
    // What held before holds what Coulomb allows; what slides in an impact holds nothing.
    const double longest = stretch.isZero(0) ? 0 : limit / shear, stretched = trial.norm();
    if (stretched > longest) kept *= longest / stretched;
  }
  return friction;
}

}  // namespace

Vector3d friction_force(const LocalPair& local, ContactPoint& point, const BodyState& a,
                        const BodyState& b, const Grip& grip, const ContactSettings& settings,
                        double& sheared) {
  const PairLaw& law = local.pair.law;
  const bool is_mindlin = settings.contact_law == NormalLaw::kHertzMindlin;
  const double ratio = is_mindlin ? law.mindlin : settings.tangential_ratio;
  const double shear = ratio * grip.stiffness;
  Vector3d stretch = b.rotation * point.stretch_b;
  // Kept in the frame of b, it turned with b; it turns with the mean of both, whichever is b.
  stretch += (0.5 * grip.drift * point.normal.dot(a.spin - b.spin)) * point.normal.cross(stretch);
  stretch = turned_into_plane(stretch, point.normal);
  if (is_mindlin) {
    if (point.shear > 0 && shear > point.shear) stretch *= point.shear / shear;
    point.shear = shear;
  }
  const Vector3d trial = stretch + grip.drift * grip.sliding;
  const double limit = law.friction * grip.load;
  Vector3d kept = trial, friction;
  if (settings.tangential_law == TangentialLaw::kRigidStick) {
    friction = rigid_stick(point, a, b, grip, shear, limit, stretch, kept);
  } else {
    const double viscous = grip.damping * ratio;
    friction = -shear * trial - viscous * grip.sliding;
    const double size = friction.norm();
    if (size > limit) {
      point.has_slid = true;
      friction *= limit / size;
      // Sliding, the spring holds what Coulomb allows; the damper must not load it.
      const double longest = limit / shear, stretched = trial.norm();
      if (stretched > longest) kept *= longest / stretched;
    }
  }
  point.stretch_b = b.rotation.transpose() * kept;
  sheared = 0.5 * shear * kept.squaredNorm();
  return friction;
}

Vector3d rolling_torque(const LocalPair& local, ContactPoint& point, const BodyState& a,
                        const BodyState& b, const Grip& grip, const ContactSettings& settings,
                        double& sheared) {
  const PairLaw& law = local.pair.law;
  const Vector3d& n = point.normal;
  const double stiffness = settings.tangential_ratio * grip.stiffness;
  const double damping = 2 * kRollingDamping * std::sqrt(stiffness / inverse_pair_mass(a, b));
  // Way of the contact over the surfaces (m): the part of the turn across the normal, times radius.
  const Vector3d turning = a.spin - b.spin;
  const Vector3d rolling = law.radius * (turning - n.dot(turning) * n);
  Vector3d rolled = b.rotation * point.rolled_b;
  rolled -= n.dot(rolled) * n;
  rolled += grip.drift * rolling;
  Vector3d force = -stiffness * rolled - damping * rolling;
  const double limit = law.rolling_friction * grip.load, size = force.norm();
  if (size > limit) {
    force *= limit / size;
    const double longest = limit / stiffness, stretched = rolled.norm();
    if (stretched > longest) rolled *= longest / stretched;
  }
  point.rolled_b = b.rotation.transpose() * rolled;
  sheared = 0.5 * stiffness * rolled.squaredNorm();
  return law.radius * force;
}

}  // namespace verisim::dem
