// SPDX-License-Identifier: MIT
// All forces at the present places and velocities, as a list of phases.
#include "dem/forces.h"

#include "dem/contacts.h"
#include "dem/loads.h"

namespace verisim::dem {
namespace {

void update_neighbours(World& world) {
  if (!margins_used_up(world.neighbours, world.bodies, *world.pool)) return;
  carry_contacts(world.contacts, world.neighbours, world.rows);
  rebuild(world.neighbours, world.rows, world.bodies, world.particles, world.planes,
          world.parameters.dt, *world.pool);
  restore_contacts(world.contacts, world.neighbours, world.rows, world.bodies, world.particles,
                   world.planes, world.time);
}

}  // namespace

int evaluate_forces(World& world, double kick_duration) {
  update_neighbours(world);                                              // neighbours.cpp
  refresh_rows(world.rows, world.bodies, world.particles, *world.pool);  // particle_rows.cpp
  world.balance.contacts = evaluate_contacts(                            // contacts.cpp
      world.rows, world.neighbours, world.contacts, world.planes,
      contact_law(world.parameters.seed), world.balance.contact_blocks, *world.pool);
  record_transitions(world.contacts, world.neighbours, world.rows,  // contact_book.cpp
                     world.bodies.count(), world.time);
  return load_bodies(world, kick_duration);  // loads.cpp
}

}  // namespace verisim::dem
