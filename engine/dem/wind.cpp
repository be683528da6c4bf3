// SPDX-License-Identifier: MIT
#include "dem/wind.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

// Schiller and Naumann's drag coefficient ends at this Reynolds number; beyond it is constant.
constexpr double kTurbulent = 1000, kTurbulentDrag = 0.44;
// Share of a velocity that drag may take in one step: terminal velocities are then right to 1e-4.
constexpr double kShareOfStep = 0.02;
// Turn (rad) of a body in one step, as its drag depends on how it lies.
constexpr double kTurn = 0.1;

Vector3d load_on_sphere(double radius, const Vector3d& through_air, const Wind& wind) {
  const double speed = through_air.norm(), diameter = 2 * radius;
  const double area = std::numbers::pi * radius * radius;
  const bool is_turbulent = wind.density * speed * diameter >= kTurbulent * wind.viscosity;
  if (is_turbulent) return -0.5 * wind.density * kTurbulentDrag * area * speed * through_air;
  const double reynolds = wind.density * speed * diameter / wind.viscosity;
  return -3 * std::numbers::pi * wind.viscosity * diameter *
         (1 + 0.15 * std::pow(reynolds, 0.687)) * through_air;
}

/// Bound on the share of its velocity through the air that drag takes from a body per time (1/s).
double rate_of(const BodyState& body, const Vector3d& velocity, const Wind& wind) {
  if (const auto* sphere = std::get_if<SphereShape>(body.shape)) {
    const Vector3d through_air = velocity - wind.velocity;
    const double speed = through_air.norm();
    if (!(speed > 0)) return 0;
    return 2 * load_on_sphere(sphere->radius, through_air, wind).norm() * body.inverse_mass / speed;
  }
  const double turning = body.inverse_inertia_b.trace();
  double rate = 0;
  for (const DragPatch& patch : *body.drag_patches) {
    const Vector3d arm = body.rotation * patch.position_b;
    const double into_air =
        (body.rotation * patch.normal_b).dot(velocity + body.spin.cross(arm) - wind.velocity);
    if (into_air <= 0) continue;
    rate += wind.density * wind.drag_coefficient * patch.area * into_air *
            (body.inverse_mass + turning * arm.squaredNorm());
  }
  return rate;
}

}  // namespace

AirLoad air_load(const BodyState& body, const Vector3d& velocity, const Vector3d& spin,
                 const Wind& wind) {
  if (const auto* sphere = std::get_if<SphereShape>(body.shape)) {
    return {load_on_sphere(sphere->radius, velocity - wind.velocity, wind), Vector3d::Zero()};
  }
  AirLoad load;
  for (const DragPatch& patch : *body.drag_patches) {
    const Vector3d arm = body.rotation * patch.position_b, normal = body.rotation * patch.normal_b;
    const double into_air = normal.dot(velocity + spin.cross(arm) - wind.velocity);
    if (into_air <= 0) continue;
    const Vector3d force =
        -0.5 * wind.density * wind.drag_coefficient * patch.area * into_air * into_air * normal;
    load.force += force;
    load.torque += arm.cross(force);
  }
  return load;
}

double wind_step(Island& island, const Wind& wind, const Vector3d& gravity, double longest) {
  double step = longest;
  for (int i = 0; i < island.num_free; ++i) {
    BodyState& body = island.bodies[static_cast<std::size_t>(i)];
    const AirLoad load = air_load(body, body.velocity, body.spin, wind);
    body.other_acceleration += load.force.norm() * body.inverse_mass +
                               (body.inverse_inertia * load.torque).norm() * body.reach;
    // The rate grows with the speed that gravity gives: (rate + growth h) h = share.
    const double rate = rate_of(body, body.velocity, wind);
    const double later = rate_of(body, body.velocity + longest * gravity, wind);
    const double growth = std::max(0.0, later - rate) / longest;
    const double root = rate + std::sqrt(rate * rate + 4 * growth * kShareOfStep);
    if (!(root > 0)) continue;
    step = std::min(step, 2 * kShareOfStep / root);
    const double spin = body.spin.norm();
    const bool is_round = std::holds_alternative<SphereShape>(*body.shape);
    if (!is_round && spin > 0) step = std::min(step, kTurn / spin);
  }
  return step;
}

void blow(Island& island, double duration, const Wind& wind) {
  IslandBooks& books = island.books;
  for (int i = 0; i < island.num_free; ++i) {
    BodyState& body = island.bodies[static_cast<std::size_t>(i)];
    const AirLoad first = air_load(body, body.velocity, body.spin, wind);
    const Vector3d middle_velocity =
        body.velocity + (0.5 * duration * body.inverse_mass) * first.force;
    const Vector3d middle_spin = body.spin + 0.5 * duration * (body.inverse_inertia * first.torque);
    const AirLoad load = air_load(body, middle_velocity, middle_spin, wind);
    const Vector3d old_velocity = body.velocity, old_spin = body.spin;
    body.velocity += (duration * body.inverse_mass) * load.force;
    body.angular_momentum += duration * load.torque;
    body.spin = body.inverse_inertia * body.angular_momentum;
    // Impulse times mean velocity is the change of kinetic energy, whatever the duration.
    books.outside_work +=
        0.5 * duration *
        (load.force.dot(old_velocity + body.velocity) + load.torque.dot(old_spin + body.spin));
    const Vector3d moment = body.position.cross(load.force) + load.torque;
    books.impulse += duration * load.force;
    books.angular_impulse += duration * moment;
    books.impulse_size += duration * load.force.norm();
    books.angular_impulse_size += duration * moment.norm();
  }
}

HeldWind::HeldWind(Island& island, const std::optional<Wind>& wind) : island_(island) {
  if (!wind) return;
  for (int i = 0; i < island.num_free; ++i) {
    BodyState& body = island.bodies[static_cast<std::size_t>(i)];
    before_.push_back({body.outside_force, body.outside_torque});
    const AirLoad load = air_load(body, body.velocity, body.spin, *wind);
    body.outside_force += load.force;
    body.outside_torque += load.torque;
  }
}

HeldWind::~HeldWind() {
  for (std::size_t i = 0; i < before_.size(); ++i) {
    island_.bodies[i].outside_force = before_[i].force;
    island_.bodies[i].outside_torque = before_[i].torque;
  }
}

}  // namespace verisim::dem
