// SPDX-License-Identifier: MIT
// Watches a run and says when it stops being right.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "dem/metrics.h"
#include "dem/pair_table.h"
#include "dem/run.h"
#include "dem/world.h"

namespace verisim::dem {

/// Records the first failure of each code. Nothing is corrected: the run goes on as it is.
class FailureWatch {
 public:
  FailureWatch(const World& world, const std::vector<Expectation>& expect, double duration);

  /// Looks at the step just done. False: the run must stop (not finite, or exploded).
  bool observe(const World& world, const StepReport& report);

  /// Judges the expectations; call at the end of a run that was not stopped.
  void finish(const World& world);

  const std::vector<Failure>& failures() const { return failures_; }

 private:
  /// One body that ought to stand.
  struct Standing {
    int body;
    Eigen::Vector3d start;  // m
    Eigen::Quaterniond start_orientation;
    Eigen::Vector3d middle;    // m, when half of the run is over
    double speed_squared = 0;  // (m/s)^2, sum over the second half
    // When the body left its bounds for good (s); < 0: it is inside.
    double toppled_since = -1, sank_since = -1, moved_since = -1;
  };

  void fail(const World& world, const char* code, int body, double time,
            const std::string& message);
  bool has_failed(const std::string& code) const;
  bool check_energy(const World& world, const StepReport& report);  // false: exploded
  void check_planes(const World& world);
  void note_deep_pairs(const World& world);
  void check_flips(const World& world);
  void check_leaps(const World& world);
  void remember_deep(const Bodies& bodies, int a, int b);  // a < b
  // Of method `dem` (surface_failures.cpp).
  void start_surfaces(const World& world);
  void note_deep_surfaces(const World& world, const StepReport& report);
  void check_centres(const World& world);
  void follow_standing(const World& world);

  std::vector<Failure> failures_;
  std::vector<Standing> standing_;
  Eigen::Vector3d up_;
  double weight_ = 0;              // N, of all free bodies
  double least_energy_scale_ = 0;  // J
  double explosion_energy_ = 0;    // J, set when energy_gain is seen
  double half_time_ = 0;           // s
  long half_steps_ = 0;            // steps of the second half
  double overlap_before_half_ = 0, contacts_before_half_ = 0;
  std::vector<std::uint8_t> starts_above_;        // [B * P] body starts outside of the plane
  PairTable<int> deep_;                           // pairs of bodies too deep in each other -> which
  std::vector<Eigen::Vector3d> apart_when_deep_;  // m, centre a - centre b
  std::vector<std::uint8_t> holds_own_centre_;    // [B] of `dem`: the centre is inside the solid
  PairTable<std::uint8_t> inside_at_start_;       // pairs of which one holds the other's centre
};

}  // namespace verisim::dem
