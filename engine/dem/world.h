// SPDX-License-Identifier: MIT
// A simulated world: its state, its parameters, what an outside hand may change, and its step.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dem/balance.h"
#include "dem/bodies.h"
#include "dem/contact_book.h"
#include "dem/definition.h"
#include "dem/metrics.h"
#include "dem/neighbours.h"
#include "dem/particle_rows.h"
#include "dem/pose_log.h"
#include "dem/thread_pool.h"

namespace verisim::dem {

/// A spring from a point of a body to a point of the world: the mouse in the viewer.
struct Drag {
  int body = -1;
  Eigen::Vector3d grip_b = Eigen::Vector3d::Zero();  // m, body frame, from the centre of mass
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  // m, world
  double stiffness = 0;                              // N/m
  double damping = 0;                                // N s/m
};

/// Values that may change between steps; use the set_ functions, they keep the books.
struct Parameters {
  Method method;
  Eigen::Vector3d gravity;  // m/s^2
  SeedSettings seed;
  Integrator integrator;
  DemSettings dem;
  XpbdSettings xpbd;
  double dt;  // s; of `dem` and `xpbd` the frame, within which islands choose their own steps
};

class SurfaceContacts;

struct World {
  // In world.cpp: written out at every use they would cost minutes of compilation.
  World();
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  std::vector<std::string> names;  // [B]
  std::vector<PlaneDefinition> planes;
  Parameters parameters;
  Bodies bodies;
  Particles particles;
  double time = 0;  // s
  long steps = 0;
  bool halted = false;              // a load was not finite: step does nothing any more
  bool has_outside_wrench = false;  // of any body
  std::optional<Drag> drag;
  Eigen::Vector3d drag_force = Eigen::Vector3d::Zero();   // N, at the last evaluation
  Eigen::Vector3d drag_torque = Eigen::Vector3d::Zero();  // N m

  Neighbours neighbours;  // which particles may touch soon
  ParticleRows rows;      // those particles, in cell order: place, motion, force
  ContactBook contacts;   // which bodies touch, and this step's events
  Balance balance;        // energies, work and momentum so far
  std::unique_ptr<ThreadPool> pool;
  std::unique_ptr<SurfaceContacts> surfaces;  // of methods `dem` and `xpbd`
};

/// What one step saw.
struct StepReport {
  int nonfinite_body = -1;  // first body whose load is not finite; the state is the last good
  bool too_deep = false;    // an overlap beyond half a particle diameter
  double max_overlap = 0;   // m
  double energy_gain = 0;   // J, beyond start and outside work; <= 0 but for errors
  long num_contacts = 0;    // particle contacts at the end of the step
};

/// A world at time 0 with its forces evaluated.
/// Throws std::invalid_argument with every problem of the definition, one per line.
World make_world(const WorldDefinition& definition);

/// Advances the world by parameters.dt; does nothing once a load was not finite.
StepReport step(World& world);

// Changes between steps. Energy that a change gives or takes is booked as work of outside agents.
// Values that are not finite or out of range throw std::invalid_argument.
void set_gravity(World& world, const Eigen::Vector3d& gravity);
void set_stiffness(World& world, double stiffness);             // N/m, > 0
void set_damping_ratio(World& world, double ratio);             // >= 0
void set_tangential_damping_ratio(World& world, double ratio);  // >= 0
void set_dt(World& world, double dt);                           // s, > 0
void set_integrator(World& world, Integrator integrator);
/// Force (N) through the centre of mass and torque (N m) on a free body, held until set again.
void set_outside_wrench(World& world, int body, const Eigen::Vector3d& force,
                        const Eigen::Vector3d& torque);
void set_drag(World& world, const std::optional<Drag>& drag);

Pose pose_of(const World& world, int body);
Metrics metrics_of(const World& world);

}  // namespace verisim::dem
