// SPDX-License-Identifier: MIT
// One step, as a list of its phases.
#include "dem/advance.h"
#include "dem/forces.h"
#include "dem/surface_contacts.h"
#include "dem/world.h"

namespace verisim::dem {

StepReport step(World& world) {
  StepReport report;
  if (world.halted) return report;
  if (world.surfaces) return step_surfaces(world);
  const double dt = world.parameters.dt;
  // `seed` lets the forces act for the whole step at once, rkmk4 half before and half after.
  const bool kicks_twice = world.parameters.integrator == Integrator::kRkmk4;
  world.contacts.events.clear();

  move_bodies(world, kicks_twice ? dt / 2 : dt, dt);                         // advance.cpp
  report.nonfinite_body = evaluate_forces(world, kicks_twice ? dt / 2 : 0);  // forces.cpp
  world.halted = report.nonfinite_body >= 0;
  if (world.halted) return report;
  count_step(world.balance);  // balance.cpp

  ++world.steps;
  const ContactSums& contacts = world.balance.contacts;
  report.too_deep = contacts.max_excess > 0;
  report.max_overlap = contacts.max_overlap;
  report.num_contacts = contacts.num_contacts;
  report.energy_gain = world.balance.energy_gain();
  return report;
}

}  // namespace verisim::dem
