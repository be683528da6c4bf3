// SPDX-License-Identifier: MIT
// Wind against closed forms: terminal velocity (MFIX DEM06), quadratic drag, plates, and the books.
#include <doctest/doctest.h>

#include <cmath>

#include "dem/wind.h"
#include "verify_worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

namespace {

/// Faces of a box as `count` x `count` patches each.
VERISIM_OUT_OF_LINE std::vector<DragPatch> box_patches(const Vector3d& edges, int count) {
  std::vector<DragPatch> patches;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const double side : {-0.5, 0.5}) {
      for (int i = 0; i < count; ++i) {
        for (int j = 0; j < count; ++j) {
          DragPatch patch{Vector3d::Zero(), Vector3d::Zero(),
                          edges[u] * edges[v] / (count * count)};
          patch.position_b[axis] = side * edges[axis];
          patch.position_b[u] = ((i + 0.5) / count - 0.5) * edges[u];
          patch.position_b[v] = ((j + 0.5) / count - 0.5) * edges[v];
          patch.normal_b[axis] = side > 0 ? 1 : -1;
          patches.push_back(patch);
        }
      }
    }
  }
  return patches;
}

VERISIM_OUT_OF_LINE BodyDefinition plate(const Vector3d& edges, double mass,
                                         const Vector3d& position) {
  BodyDefinition body = solid_box(edges, mass, position);
  body.drag_patches = box_patches(edges, 8);
  return body;
}

VERISIM_OUT_OF_LINE WorldDefinition windy(BodyDefinition body, const Wind& wind) {
  WorldDefinition definition = free_world({std::move(body)}, 0.5, 0.5);
  definition.gravity = {0, 0, -kGravity};
  definition.wind = wind;
  return definition;
}

void check_books(const Watched& watched) {
  CHECK_FALSE(watched.result.failed.has_value());
  CHECK(watched.result.metrics.energy_residual_rel < 1e-10);
  CHECK(watched.momentum_rel < 1e-12);
}

}  // namespace

TEST_CASE("mfix_dem06_a_small_sphere_falls_at_its_terminal_velocity") {
  // d 0.1 mm, 2000 kg/m^3, air 1.2 kg/m^3 and 1.8e-5 Pa s, up-flow 0.4 m/s. The root of Schiller
  // and Naumann's drag = weight is 0.45777 m/s through the gas, Reynolds number 3.05.
  const Wind air{.velocity = {0, 0, 0.4}, .density = 1.2, .viscosity = 1.8e-5};
  const Watched watched = watch(windy(solid_ball(0.5e-4, 2000, {0, 0, 1}), air), 1.5);
  const double through_gas = 0.4 - watched.end(0).linear_velocity.z();
  tell("DEM06: velocity through the gas, residual", through_gas,
       watched.result.metrics.energy_residual_rel);
  CHECK(std::abs(through_gas / 0.45777 - 1) < 5e-3);  // measured 1e-6
  check_books(watched);
}

TEST_CASE("a_sphere_in_quadratic_drag_nears_its_terminal_velocity_by_the_tanh_law") {
  // v = v_t tanh(g t / v_t), v_t = sqrt(2 m g / (rho C A)) with C 0.44; hardly any viscosity, so
  // that Re > 1000 from the start.
  const Wind air{.density = 1.2, .viscosity = 1e-9};
  const double radius = 0.05, density = 30;
  const double terminal = std::sqrt(2 * density * (4.0 / 3) * radius * kGravity / (1.2 * 0.44));
  double worst = 0;
  const Watched watched = watch(windy(solid_ball(radius, density, {0, 0, 0}), air), 3);
  const PoseLog& log = watched.result.log;
  for (std::size_t t = 1; t < log.num_times(); ++t) {
    const double exact = terminal * std::tanh(kGravity * log.times[t] / terminal);
    worst = std::max(worst, std::abs(-log.at(t, 0).linear_velocity.z() / exact - 1));
  }
  tell("tanh law: worst error, terminal velocity", worst, terminal);
  CHECK(worst < 1e-3);  // measured 6e-5
  check_books(watched);
}

TEST_CASE("a_leaf_let_go_in_still_air_does_not_overshoot_its_terminal_velocity") {
  // Terminal velocity 5 cm/s: passed within 5 ms, a third of a frame, if nothing held it.
  const double mass = 1.2 * 0.06 * 0.05 * 0.05 / (2 * kGravity);
  const Watched watched = watch(windy(plate({0.3, 0.2, 1e-4}, mass, {0, 0, 0}), Wind{}), 0.1);
  double fastest = 0;
  for (const Pose& pose : watched.result.log.poses) {
    fastest = std::max(fastest, pose.linear_velocity.norm());
  }
  tell("leaf: fastest, last", fastest, watched.end(0).linear_velocity.norm());
  CHECK(fastest < 0.05 * 1.001);
  CHECK(std::abs(watched.end(0).linear_velocity.norm() / 0.05 - 1) < 1e-3);  // measured 2e-5
  check_books(watched);
}

TEST_CASE("a_plate_across_the_wind_feels_half_rho_c_a_v_squared") {
  // Edge on it feels its edge alone; at 60 degrees the normal part, squared, along its normal.
  const Vector3d edges(0.3, 0.2, 0.01);
  const Wind air{.velocity = {0, 0, 5}, .drag_coefficient = 1.17};
  WorldDefinition definition = windy(plate(edges, 1, {0, 0, 0}), air);
  for (const double tilt : {0.0, 60.0, 90.0}) {
    definition.bodies[0].initial.orientation = turned(tilt, {0, 1, 0});
    definition.gravity.setZero();
    definition.dt = 1e-4;
    World world = make_world(definition);
    step(world);
    const Vector3d force = world.bodies.linear_velocity[0] / definition.dt;  // mass 1 kg
    const double cosine = std::cos(radians(tilt)), sine = std::sin(radians(tilt));
    const double pressure = 0.5 * 1.2 * 1.17 * 25;
    // Of the large face along (sine, 0, cosine), of the 0.2 x 0.01 m edge along (-cosine, 0, sine).
    const double face = pressure * 0.06 * cosine * cosine;
    const double edge = pressure * 0.002 * sine * sine;
    const Vector3d exact(face * sine - edge * cosine, 0, face * cosine + edge * sine);
    tell("plate: tilt, error of force", tilt, (force - exact).norm() / exact.norm());
    CHECK((force - exact).norm() < 0.01 * exact.norm());  // measured 2e-5
  }
}

TEST_CASE("a_falling_plate_reaches_the_speed_at_which_drag_carries_it") {
  const Vector3d edges(0.3, 0.2, 0.01);
  const Watched watched = watch(windy(plate(edges, 0.05, {0, 0, 0}), Wind{}), 4);
  const double terminal = std::sqrt(2 * 0.05 * kGravity / (1.2 * 0.06));
  const double speed = -watched.end(0).linear_velocity.z();
  tell("plate: terminal velocity", speed, terminal);
  CHECK(std::abs(speed / terminal - 1) < 1e-3);  // measured 1e-6
  check_books(watched);
}

TEST_CASE("a_spinning_plate_is_slowed_by_the_integral_over_its_faces") {
  // Spin w about its long edge: half of each large face moves into the air, torque
  // 2 x 1/2 rho w^2 L int_0^(b/2) y^3 dy = rho w^2 L (b/2)^4 / 4, no force in sum.
  const Vector3d edges(0.3, 0.2, 1e-4);
  BodyDefinition body = plate(edges, 0.05, {0, 0, 0});
  body.drag_patches = box_patches(edges, 40);
  body.initial.angular_velocity = {10, 0, 0};
  WorldDefinition definition = free_world({body}, 0.5, 0.5);
  definition.wind = Wind{};
  definition.dt = 1e-4;
  World world = make_world(definition);
  step(world);
  const double torque =
      (world.bodies.angular_momentum[0].x() - body.inertia_b(0, 0) * 10) / definition.dt;
  const double exact = -1.2 * 100 * 0.3 * std::pow(0.1, 4) / 4;
  tell("spinning plate: torque", torque, exact);
  CHECK(std::abs(torque / exact - 1) < 0.01);  // measured 1.3e-3
  CHECK(world.bodies.linear_velocity[0].norm() < 1e-12);
}

TEST_CASE("a_ball_dropped_in_still_air_keeps_its_books_through_bounces") {
  for (const Steps steps : kBothSteps) {
    WorldDefinition definition = floor_world({solid_ball(0.05, 30, {0, 0, 1})}, 0.8, 0.5, steps);
    definition.wind = Wind{.velocity = {2, 0, 0}};
    const Watched watched = watch(definition, 3);
    tell("ball in wind: residual, momentum, end speed", watched.result.metrics.energy_residual_rel,
         watched.momentum_rel, watched.end(0).linear_velocity.x());
    CHECK_FALSE(watched.result.failed.has_value());
    CHECK(watched.result.metrics.energy_residual_rel < 1e-3);  // measured 1.9e-4
    CHECK(watched.momentum_rel < 1e-10);
    // The wind sets it rolling downwind.
    CHECK(watched.end(0).linear_velocity.x() > 0.3);
    CHECK(watched.end(0).linear_velocity.x() < 2);
  }
}

TEST_CASE("a_resting_box_stands_in_a_wind_that_friction_holds_and_slides_in_a_stronger_one") {
  // 0.1 m cube of 0.1 kg: 1/2 rho A v^2 = mu m g at v = 9.04 m/s for mu 0.5. It would tip at the
  // same wind (half its width to half its height is 1 > mu, so it slides first).
  BodyDefinition body = plate({0.1, 0.1, 0.1}, 0.1, {0, 0, 0.05});
  const double limit = std::sqrt(2 * 0.5 * 0.1 * kGravity / (1.2 * 0.01));
  for (const double share : {0.95, 1.05}) {
    WorldDefinition definition = floor_world({body}, 0.3, 0.5);
    definition.wind = Wind{.velocity = {share * limit, 0, 0}};
    const Watched watched = watch(definition, 1);
    tell("box in wind: share of the limit, way", share, watched.end(0).position.x());
    CHECK_FALSE(watched.result.failed.has_value());
    CHECK(watched.result.metrics.energy_residual_rel < 1e-3);
    if (share < 1) {
      CHECK(watched.end(0).position.x() < 1e-4);
    } else {
      CHECK(watched.end(0).position.x() > 0.1);
    }
  }
}
