// SPDX-License-Identifier: MIT
// The contact points of an implicit step, four side by side: the inner loops of its problem.
#pragma once

#include <array>
#include <vector>

#include "dem/block_matrix.h"
#include "dem/contact_pair.h"
#include "dem/island.h"
#include "dem/lanes.h"

namespace verisim::dem {

/// A contact point as the problem sees it. a and b are free bodies or -1.
struct RestRow {
  int a = -1, b = -1;
  LocalPair* local = nullptr;
  ContactPoint* point = nullptr;
  Eigen::Vector3d normal, arm_a, arm_b;               // m, from the centres of mass
  Eigen::Vector3d given = Eigen::Vector3d::Zero();    // m/s, relative velocity of bodies not free
  Eigen::Vector3d stretch = Eigen::Vector3d::Zero();  // m, at the start of the step
  double compression = 0;                             // m, at the start; < 0 apart
  double stiffness = 0;                               // N/m, normal
  double damping = 0;                                 // N s/m, normal
  double rebound = 0;                                 // m/s, of an impact; see RestProblem
  double shear = 0;                                   // N/m, tangential
  double friction = 0;                                // coefficient
  double bound = 0;                                   // N, of the friction in this pass
  double load = 0;                                    // N, normal, at the solution
  Eigen::Vector3d tangential = Eigen::Vector3d::Zero();  // N, friction on a, at the solution
  bool is_softened = false;                              // what sticks may slip
};

/// Relative velocity (m/s) at a row for velocities and spins of the free bodies.
Eigen::Vector3d relative_velocity(const RestRow& row, const std::vector<Vector6>& v);

/// Rows for the loops of the problem; all sums have one order on every processor.
class RestRows {
 public:
  /// Tangential springs act over four steps: three steps' worth of their stiffness as damping.
  static constexpr double kTangentialSteps = 4;

  void set_places(const std::vector<RestRow>& rows, std::size_t num_bodies, double duration);
  void set_springs(const std::vector<RestRow>& rows);
  /// Sets the bounds of friction. What sticks may slip by `slip_speed` (m/s) before it reaches its
  /// bound: at 0 only as its spring gives way.
  void set_bounds(const std::vector<RestRow>& rows, double slip_speed);
  /// Loads and tangential forces of the last evaluation.
  void take_forces(std::vector<RestRow>& rows) const;

  /// Subtracts from `gradient` the impulses of all rows at velocities `v`.
  void evaluate(const std::vector<Vector6>& v, std::vector<Vector6>& gradient);
  /// The line through the velocities of the last evaluation.
  void set_direction(const std::vector<Vector6>& direction);
  /// Slope of the rows' part of the objective at `t` along it.
  double slope(double t) const;
  /// Adds the rows' second derivatives at the last evaluation; what slides has none along its slip
  /// but 1 - `sliding_share` of what it would have stuck.
  void add_stiffness(double sliding_share, BlockMatrix& matrix);
  /// The pairs of two free bodies, as edges of the matrix.
  void list_edges(BlockMatrix& matrix) const;

  /// Four rows; what is beyond the last is zero and belongs to no body.
  struct Four {
    Lanes normal[3], arm_a[3], arm_b[3], given[3], stretch[3];
    Lanes base_arm[3];                   // of a where a is free, else of b
    Lanes compression, stiffness, push;  // push: of velocity on the load, N s/m
    Lanes rebound;                       // m/s
    Lanes shear, grip, bound;            // grip: the shear stiffness that velocities meet, N/m
    Lanes u[3], du[3];                   // m/s
    Lanes load, pull[3], size;           // N; size of the spring's pull, uncapped
    std::array<int, 4> a, b;
  };
  /// Second derivatives of a row at the arm from its base body: force over displacement, the same
  /// over turns, torque over turns.
  static constexpr int kEntries = 21;
  struct FourDerivatives {
    Lanes entry[kEntries];
  };

 private:
  struct Pair {
    int first, last;           // rows
    int a, b, edge;            // free bodies or -1
    Eigen::Vector3d a_from_b;  // m, between centres of mass
  };
  void take_pair_stiffness(const Pair& pair, BlockMatrix& matrix) const;

  double h_ = 0;
  std::size_t num_bodies_ = 0;
  std::vector<Four> fours_;
  std::vector<FourDerivatives> derivatives_;
  std::vector<Pair> pairs_;
  std::vector<Vector6> bodies_, sums_;  // [N + 1], the last for all that is not free
};

}  // namespace verisim::dem
