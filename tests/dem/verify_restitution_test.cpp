// SPDX-License-Identifier: MIT
// Restitution of bodies whose centre of mass is over the contact, and momentum in collisions.
#include <doctest/doctest.h>

#include <cmath>

#include "verify_worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

namespace {

constexpr double kRestitutions[] = {0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95};

enum class Lands { kSphere, kFace, kEdge, kCorner };

/// Speed of parting over speed of approach of a body of 0.1 m that meets the floor at 2 m/s without
/// gravity.
VERISIM_OUT_OF_LINE double rebound_of(Lands pose, double restitution, double& spin,
                                      double& residual) {
  BodyDefinition body = solid_box({0.1, 0.1, 0.1}, 1, {0, 0, 0.06});
  if (pose == Lands::kSphere) body = ball(0.05, 1, {0, 0, 0.06});
  if (pose == Lands::kEdge) {
    body.initial.orientation = turned(45, Vector3d::UnitX());
    body.initial.position.z() = 0.06 * std::sqrt(2.0);
  }
  if (pose == Lands::kCorner) {
    body.initial.orientation =
        Eigen::Quaterniond::FromTwoVectors(Vector3d(1, 1, 1), Vector3d::UnitZ());
    body.initial.position.z() = 0.06 * std::sqrt(3.0);
  }
  body.initial.linear_velocity.z() = -2;
  WorldDefinition definition = floor_world({body}, restitution, 0.5);
  definition.gravity.setZero();
  const Watched watched = watch(definition, 0.1);
  spin = std::max(spin, watched.end(0).angular_velocity.norm() * 0.1);
  residual = std::max(residual, watched.result.metrics.energy_residual_rel);
  return watched.end(0).linear_velocity.z() / 2;
}

}  // namespace

TEST_CASE("spheres_faces_edges_and_corners_rebound_with_the_restitution_given") {
  double worst = 0, spin = 0, residual = 0;
  for (const Lands pose : {Lands::kSphere, Lands::kFace, Lands::kEdge, Lands::kCorner}) {
    for (const double e : kRestitutions) {
      const double error = rebound_of(pose, e, spin, residual) - e;
      tell("restitution: pose, e, error", static_cast<int>(pose), e, error);
      worst = std::max(worst, std::abs(error));
    }
  }
  tell("restitution: worst, spin gained (m/s), residual", worst, spin, residual);
  CHECK(worst < 0.01);     // measured 5.5e-3
  CHECK(spin < 1e-6);      // measured 4e-16
  CHECK(residual < 1e-3);  // measured 4.9e-4
}

TEST_CASE("two_boxes_part_with_the_restitution_given") {
  double worst = 0;
  for (const double e : kRestitutions) {
    BodyDefinition left = solid_box({0.1, 0.1, 0.1}, 1, {-0.06, 0, 0});
    BodyDefinition right = solid_box({0.1, 0.16, 0.16}, 3, {0.06, 0, 0});
    left.initial.linear_velocity.x() = 1;
    right.initial.linear_velocity.x() = -1;
    const Watched watched = watch(free_world({left, right}, e, 0.5), 0.1);
    const double parting = watched.end(1).linear_velocity.x() - watched.end(0).linear_velocity.x();
    worst = std::max(worst, std::abs(parting / 2 - e));
    CHECK(watched.result.metrics.energy_residual_rel < 1e-3);
    CHECK(watched.momentum_rel < 1e-12);
  }
  tell("box on box: worst error of e", worst);
  CHECK(worst < 0.01);  // measured 5.2e-3
}

TEST_CASE("isolated_collisions_conserve_linear_and_angular_momentum_to_rounding") {
  // Off centre, spinning, with friction; relative to the sums of the bodies' own momenta.
  double worst_linear = 0, worst_angular = 0, worst_residual = 0, worst_rise = 0;
  int collisions = 0;
  for (int i = 0; i < 8; ++i) {
    const Watched watched = watch(isolated_collision(i), 0.4);
    collisions += watched.result.events.empty() ? 0 : 1;
    const Balance& books = watched.world.balance;
    const double linear = (books.momentum - books.momentum_start).norm() / (2 + 3);
    const double angular = (books.angular_momentum - books.angular_momentum_start).norm() /
                           books.angular_momentum_start.norm();
    worst_linear = std::max(worst_linear, linear);
    worst_angular = std::max(worst_angular, angular);
    worst_residual = std::max(worst_residual, watched.result.metrics.energy_residual_rel);
    worst_rise = std::max(worst_rise, watched.rise_rel);
    tell("collision: boxes, linear, angular, residual, rise", i % 2 == 1, linear, angular,
         watched.result.metrics.energy_residual_rel, watched.rise_rel);
  }
  CHECK(collisions == 8);
  CHECK(worst_linear < 1e-12);   // measured 2e-16
  CHECK(worst_angular < 1e-12);  // measured 2.4e-15
  CHECK(worst_residual < 1e-3);  // measured 4.9e-4
  CHECK(worst_rise < 1e-6);      // measured 7e-12
}
