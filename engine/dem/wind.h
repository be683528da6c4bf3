// SPDX-License-Identifier: MIT
// Moving air pushes bodies: quadratic drag on windward surfaces, Schiller and Naumann for spheres.
#pragma once

#include <optional>
#include <vector>

#include "dem/island.h"

namespace verisim::dem {

/// Force and torque about the centre of mass.
struct AirLoad {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // N
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // N m
};

/// What the air does to a body at the given velocities.
/// A sphere of diameter d: 3 pi mu d (1 + 0.15 Re^0.687) u against its velocity u through the air
/// up to Re = 1000, drag coefficient 0.44 beyond (Schiller and Naumann 1933); its spin feels
/// nothing. Other shapes: -1/2 rho C u_n^2 n A on every patch that moves into the air (u_n > 0);
/// patches do not shade each other. No buoyancy.
AirLoad air_load(const BodyState& body, const Eigen::Vector3d& velocity,
                 const Eigen::Vector3d& spin, const Wind& wind);

/// Longest step, at most `longest` (s), over which drag changes the velocities of an island little,
/// also those that gravity gives on the way. Adds to the bodies' other_acceleration.
double wind_step(Island& island, const Wind& wind, const Eigen::Vector3d& gravity, double longest);

/// Changes the momenta by `duration` (s) of drag at fixed poses, second order; the books take the
/// change of kinetic energy as work from outside. Half of it before and half after a step without
/// air make that step second order as well (Strang 1968).
void blow(Island& island, double duration, const Wind& wind);

/// While it lives, the present air load acts on the bodies of an island as a load from outside:
/// for implicit steps, over which it changes little.
class HeldWind {
 public:
  HeldWind(Island& island, const std::optional<Wind>& wind);
  ~HeldWind();
  HeldWind(const HeldWind&) = delete;
  HeldWind& operator=(const HeldWind&) = delete;

 private:
  Island& island_;
  std::vector<AirLoad> before_;  // outside loads of the free bodies; empty without wind
};

}  // namespace verisim::dem
