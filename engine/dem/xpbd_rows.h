// SPDX-License-Identifier: MIT
// Unilateral constraints with Coulomb friction, one per contact point, and Gauss-Seidel sweeps over
// them. The same rows serve displacements (m; loads in kg m) and velocities (m/s; loads in N s).
#pragma once

#include <vector>

#include "dem/island.h"

namespace verisim::dem {

/// How a body moves: of positions a correction, of velocities the velocity itself.
struct Rates {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();
};

/// One contact point. Its load pushes body a along the normal and body b against it.
struct Row {
  int pair = 0, point = 0;                          // in Island::pairs, ContactPair::points
  int a = 0, b = 0;                                 // in Island::bodies
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // m, world: where the load acts on both
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d arm_a = Eigen::Vector3d::Zero(), arm_b = Eigen::Vector3d::Zero();
  Eigen::Vector3d lever_a = Eigen::Vector3d::Zero(), lever_b = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_a = Eigen::Vector3d::Zero(), turn_b = Eigen::Vector3d::Zero();
  double inverse_mass = 0;  // 1/kg, of both bodies at the point along the normal
  Eigen::Matrix3d inverse_masses = Eigen::Matrix3d::Zero();  // the same along any direction
  double friction = 0;
  double target = 0;                               // least rate along the normal
  Eigen::Vector3d slip = Eigen::Vector3d::Zero();  // of positions: across the normal, before
  double load = 0;                                 // >= 0
  Eigen::Vector3d grip = Eigen::Vector3d::Zero();  // across the normal, |grip| <= friction load
  bool slides = false;                             // the bound held at the last sweep
};

/// Rows [first, end) of one pair.
struct RowBlock {
  int pair = 0, first = 0, end = 0;
};

struct Rows {
  std::vector<Row> rows;
  std::vector<RowBlock> blocks;
  void clear() {
    rows.clear();
    blocks.clear();
  }
};

/// Appends a row; it belongs to the last block if that is of the same pair. `start_a`, `start_b`:
/// the bodies' centres when the load acts (m).
Row& add_row(Rows& rows, const Island& island, int pair, int point, const Eigen::Vector3d& place,
             const Eigen::Vector3d& start_a, const Eigen::Vector3d& start_b);

/// Rate of a against b at the point.
Eigen::Vector3d relative_rate(const Row& row, const std::vector<Rates>& rates);

/// Adds a load (normal and across) to the rates of both bodies.
void apply_load(const Row& row, const Eigen::Vector3d& load, const Island& island,
                std::vector<Rates>& rates);

/// One sweep over the loads along the normals, pair by pair, `inner` times over the points of each;
/// always in the same order, or what one substep leaves over would not be what the next starts
/// from. Returns the largest change of a rate.
double sweep_loads(Rows& rows, const Island& island, int inner, std::vector<Rates>& rates);

/// The same over the grips.
double sweep_grips(Rows& rows, const Island& island, int inner, std::vector<Rates>& rates);

/// Velocities of all bodies of an island.
void read_velocities(const Island& island, std::vector<Rates>& rates);

/// Momenta of the free bodies change by `share` of all loads, which act at the rows' places.
void add_momenta(const Rows& rows, double share, Island& island);

/// Books the work and impulse of `share` of all loads, which took the velocities from `before` to
/// `after`: along the normals as damping, across them as friction, of bodies that are held or moved
/// from outside as outside work.
void book_loads(const Rows& rows, double share, const std::vector<Rates>& before,
                const std::vector<Rates>& after, Island& island);

}  // namespace verisim::dem
