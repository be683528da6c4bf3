// SPDX-License-Identifier: MIT
// Makes a world and changes it from outside, with the books kept.
#include "dem/world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "dem/forces.h"
#include "dem/surface_contacts.h"

namespace verisim::dem {
namespace {

void require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument(what);
}

void require_number(double value, double least, const std::string& name) {
  require(std::isfinite(value) && value >= least, name + " is " + std::to_string(value) +
                                                      "; it must be finite and at least " +
                                                      std::to_string(least));
}

/// Makes a change and books what it did to the stored energy as work of outside agents.
template <class Change>
void change_and_book(World& world, const Change& change) {
  Balance& balance = world.balance;
  const double before = balance.energy();
  change();
  if (world.surfaces) {
    world.surfaces->take_parameters(world);
    book_surfaces(world);
  } else {
    world.halted = evaluate_forces(world, 0) >= 0;
  }
  if (world.halted) return;
  balance.outside_work += balance.energy() - before;
}

}  // namespace

World::World() = default;
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

World make_world(const WorldDefinition& definition) {
  const std::vector<std::string> problems = problems_of(definition);
  if (!problems.empty()) {
    std::string text;
    for (const std::string& problem : problems) text += (text.empty() ? "" : "\n") + problem;
    throw std::invalid_argument(text);
  }
  World world;
  for (const BodyDefinition& body : definition.bodies) world.names.push_back(body.name);
  world.planes = definition.planes;
  for (PlaneDefinition& plane : world.planes) plane.normal.normalize();
  world.parameters = {definition.method, definition.gravity, definition.seed, definition.integrator,
                      definition.dem,    definition.xpbd,    definition.dt};
  world.bodies = make_bodies(definition);
  if (!has_surfaces(definition.method)) world.particles = make_particles(definition);
  world.pool = std::make_unique<ThreadPool>(definition.num_threads);
  if (has_surfaces(definition.method)) {
    world.surfaces = std::make_unique<SurfaceContacts>(definition);
    book_surfaces(world);
    open_books(world.balance);
    return world;
  }
  const int num_threads = world.pool->num_threads();
  world.neighbours = make_neighbours(world.bodies, world.particles, num_threads);
  world.rows = make_rows(world.bodies.count(), world.particles.count());
  world.contacts = make_contact_book(world.particles.count(), num_threads);
  world.balance.contact_blocks.reserve(
      static_cast<std::size_t>(world.particles.count() / kRowBlock) + 1);
  rebuild(world.neighbours, world.rows, world.bodies, world.particles, world.planes,
          world.parameters.dt, *world.pool);
  world.halted = evaluate_forces(world, 0) >= 0;
  open_books(world.balance);
  return world;
}

void set_gravity(World& world, const Eigen::Vector3d& gravity) {
  require(gravity.allFinite(), "gravity is not finite");
  change_and_book(world, [&] { world.parameters.gravity = gravity; });
}

void set_stiffness(World& world, double stiffness) {
  require_number(stiffness, 0, "stiffness");
  change_and_book(world, [&] {
    const bool is_seed = world.parameters.method == Method::kSeed;
    (is_seed ? world.parameters.seed.stiffness : world.parameters.dem.stiffness) = stiffness;
  });
}

void set_damping_ratio(World& world, double ratio) {
  require_number(ratio, 0, "damping ratio");
  change_and_book(world, [&] { world.parameters.seed.damping_ratio = ratio; });
}

void set_tangential_damping_ratio(World& world, double ratio) {
  require_number(ratio, 0, "tangential damping ratio");
  change_and_book(world, [&] { world.parameters.seed.tangential_damping_ratio = ratio; });
}

void set_dt(World& world, double dt) {
  require(std::isfinite(dt) && dt > 0, "dt is " + std::to_string(dt) + "; it must be above 0");
  world.parameters.dt = dt;
}

void set_integrator(World& world, Integrator integrator) {
  world.parameters.integrator = integrator;
}

void set_outside_wrench(World& world, int body, const Eigen::Vector3d& force,
                        const Eigen::Vector3d& torque) {
  require(body >= 0 && body < world.bodies.count(), "no body " + std::to_string(body));
  require(force.allFinite() && torque.allFinite(), "outside force or torque is not finite");
  change_and_book(world, [&] {
    world.bodies.outside.force[body] = force;
    world.bodies.outside.torque[body] = torque;
    world.has_outside_wrench = true;
  });
}

void set_drag(World& world, const std::optional<Drag>& drag) {
  if (drag) {
    require(drag->body >= 0 && drag->body < world.bodies.count() &&
                world.bodies.motion[drag->body] == Motion::kFree,
            "only a free body can be dragged");
    require(drag->grip_b.allFinite() && drag->target.allFinite(), "drag is not finite");
    require_number(drag->stiffness, 0, "drag stiffness");
    require_number(drag->damping, 0, "drag damping");
  }
  change_and_book(world, [&] { world.drag = drag; });
}

Pose pose_of(const World& world, int body) {
  return {world.bodies.position[body], world.bodies.orientation[body],
          world.bodies.linear_velocity[body], world.bodies.angular_velocity[body]};
}

namespace {

/// Smallest extent (m) of any free body; infinite without one.
double smallest_free_size(const Bodies& bodies) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int b = 0; b < bodies.count(); ++b) {
    if (bodies.motion[b] == Motion::kFree) smallest = std::min(smallest, bodies.size[b]);
  }
  return smallest;
}

}  // namespace

Metrics metrics_of(const World& world) {
  const Balance& balance = world.balance;
  const auto ratio = [](double part, double whole) { return whole > 0 ? part / whole : 0; };
  Metrics metrics;
  metrics.max_penetration_m = balance.max_overlap;
  metrics.mean_penetration_m = ratio(balance.overlap_total, balance.contacts_total);
  metrics.rms_penetration_m =
      std::sqrt(ratio(balance.squared_overlap_total, balance.contacts_total));
  metrics.max_penetration_rel = ratio(metrics.max_penetration_m, smallest_free_size(world.bodies));
  metrics.energy_start_j = balance.energy_start;
  metrics.energy_end_j = balance.energy();
  metrics.kinetic_energy_j = balance.kinetic_energy;
  metrics.potential_energy_j = balance.potential_energy;
  metrics.elastic_energy_j = balance.elastic_energy;
  metrics.damping_work_j = balance.damping_work;
  metrics.friction_work_j = balance.friction_work;
  metrics.outside_work_j = balance.outside_work;
  metrics.energy_scale_j = balance.energy_scale();
  metrics.energy_residual_rel = ratio(std::abs(balance.energy_residual()), balance.energy_scale());
  metrics.momentum_residual_rel = ratio(
      (balance.momentum - balance.momentum_start - balance.impulse).norm(), balance.impulse_size);
  metrics.angular_momentum_residual_rel = ratio(
      (balance.angular_momentum - balance.angular_momentum_start - balance.angular_impulse).norm(),
      balance.angular_impulse_size);
  metrics.num_particles = world.particles.count();
  if (world.surfaces) {
    metrics.energy_rise_j = world.surfaces->largest_energy_rise();
    metrics.anchor_creep_m = world.surfaces->anchor_creep();
    metrics.implicit_work_j = world.surfaces->implicit_work();
    metrics.correction_work_j = world.surfaces->correction_work();
    metrics.num_samples = world.surfaces->num_samples();
    metrics.work = world.surfaces->work();
  }
  metrics.max_contacts = balance.max_contacts;
  return metrics;
}

}  // namespace verisim::dem
