// SPDX-License-Identifier: MIT
// The convex problem of an implicit step: which velocities balance all springs at its end.
#pragma once

#include <vector>

#include "dem/block_cholesky.h"
#include "dem/island.h"
#include "dem/rest_rows.h"

namespace verisim::dem {

/// Minimises over the velocities v of the free bodies, with h the step and u = J v per row:
///   1/2 |v - v*|_M^2 + sum h/(2q) [k x - q u_n]_+^2 + sum h/(4h) Huber_{k_t, b}(s + 4h u_t),
/// q = h k + damping. The friction bound b = mu * load of the last pass is fixed meanwhile, so the
/// problem is convex; passes repeat until it no longer changes. Newton with exact line search. Of
/// rows that rebound, u_n counts from the parting speed.
class RestProblem {
 public:
  /// Result of a solve.
  struct Outcome {
    bool converged = false;
    int newton_steps = 0;
  };

  /// Takes the island's bodies and points at the start of a step of `duration` (s).
  void set_up(Island& island, double duration, const ContactSettings& settings);
  /// Takes over stiffness and offset of all points after they were changed.
  void refresh_rows(const ContactSettings& settings);
  /// `is_rough`: loads to a twentieth, where stiffness is still sought.
  Outcome solve(bool is_rough);

  std::vector<RestRow>& rows() { return rows_; }
  /// Velocity and spin of the free bodies after the step, exactly by the loads of all rows.
  const std::vector<Vector6>& velocities() const { return end_; }
  const std::vector<Vector6>& start_velocities() const { return start_; }
  /// H^-1 M c with the matrix of the last Newton step: c without its stiff directions.
  void project(std::vector<Vector6>& c);

 private:
  void evaluate(const std::vector<Vector6>& v, std::vector<Vector6>& gradient);
  void assemble(double sliding_share);
  void solve_linear(const std::vector<Vector6>& b, std::vector<Vector6>& x, double tolerance);
  double line_search(const std::vector<Vector6>& gradient, const std::vector<Vector6>& direction);
  double scaled_residual(const std::vector<Vector6>& gradient) const;
  double expected_speed_change() const;
  double start_speed() const;
  void soften(double speed);
  void apply_mass(std::vector<Vector6>& v) const;

  Island* island_ = nullptr;
  double h_ = 0;
  double gravity_ = 0;
  std::vector<RestRow> rows_;
  RestRows loops_;
  std::vector<Eigen::Matrix3d> inertia_;  // [N] world axes
  std::vector<Vector6> start_, free_, end_, v_, best_, gradient_, direction_, weighted_;
  BlockMatrix matrix_;
  BlockCholesky cholesky_;
  BlockGradients gradients_;
  bool is_direct_ = true;
  bool is_first_ = true, is_moving_ = false;  // of the solves of this step
  double speed_change_ = 0;                   // m/s, expected of the step
  double slip_speed_ = 0;                     // m/s, of what sticks
};

}  // namespace verisim::dem
