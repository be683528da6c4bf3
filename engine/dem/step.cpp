// SPDX-License-Identifier: MIT
// One step, as a list of its phases.
#include "dem/advance.h"
#include "dem/forces.h"
#include "dem/world.h"

namespace verisim::dem {

StepReport step(World& world) {
  StepReport report;
  if (world.halted) return report;
  Balance& balance = world.balance;
  const double dt = world.parameters.dt;
  // `seed` lets the forces act for the whole step at once, rkmk4 half before and half after.
  const bool kicks_twice = world.parameters.integrator == Integrator::kRkmk4;
  world.contacts.events.clear();

  kick(world, kicks_twice ? dt / 2 : dt);  // advance.cpp
  drift(world, dt);                        // advance.cpp, rotation.cpp, prescribed.cpp
  report.nonfinite_body = evaluate_forces(world);  // forces.cpp
  world.halted = report.nonfinite_body >= 0;
  if (world.halted) return report;
  if (kicks_twice) kick(world, dt / 2);
  audit(balance, world.bodies, world.parameters.gravity, *world.pool);  // balance.cpp

  ++world.steps;
  balance.overlap_total += balance.contacts.overlap;
  balance.contacts_total += static_cast<double>(balance.contacts.num_contacts);
  report.too_deep = balance.contacts.max_excess > 0;
  report.max_overlap = balance.contacts.max_overlap;
  report.energy_gain = balance.energy_gain();
  report.num_contacts = balance.contacts.num_contacts;
  return report;
}

}  // namespace verisim::dem
