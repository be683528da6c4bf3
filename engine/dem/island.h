// SPDX-License-Identifier: MIT
// Bodies that may touch each other during a frame, and how they advance through it.
#pragma once

#include <optional>
#include <vector>

#include "dem/body_state.h"
#include "dem/contact_pair.h"
#include "dem/metrics.h"

namespace verisim::dem {

/// Choices that hold for all islands of a world.
struct ContactSettings {
  Method method = Method::kDem;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  // m/s^2
  double impact_depth = 0;                            // m, compression allowed in an impact
  double rest_depth = 0;                              // m, compression allowed under a resting load
  double tangential_ratio = 0.8;                      // tangential over normal stiffness
  double impact_step = 0;  // sqrt(m/k), of an explicit step; see restitution.h
  double stiffness = 0;    // N/m; 0: from impact and load
  bool rests_implicitly = true;
  NormalLaw contact_law = NormalLaw::kHuntCrossley;
  TangentialLaw tangential_law = TangentialLaw::kSpring;
  double substep = 0;                // s, of method xpbd
  double restitution_threshold = 0;  // m/s, of method xpbd: slower approaches do not rebound
  std::optional<Wind> wind;
};

/// What an island did to the books of the world.
struct IslandBooks {
  double damping_work = 0, friction_work = 0, outside_work = 0;  // J
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();             // N s, from outside
  Eigen::Vector3d angular_impulse = Eigen::Vector3d::Zero();     // N m s, about the origin
  double impulse_size = 0, angular_impulse_size = 0;
  double elastic_energy = 0;  // J, at the end
  double shear_energy = 0;    // J, the tangential part
  double overlap_total = 0, squared_overlap_total = 0, num_overlaps = 0, max_overlap = 0;
  double least_step = 0;  // s
  long num_steps = 0, num_rest_steps = 0, max_contacts = 0;
  long num_newton_steps = 0, num_refused_steps = 0;  // of implicit steps
  double implicit_work = 0;    // J, part of damping_work: what implicit steps took out of springs
  double correction_work = 0;  // J, part of damping_work: < 0 where corrected positions lifted
  double energy_rise = 0;      // J, largest of one implicit step or substep that nothing put in
  std::vector<ContactEvent> events;
  bool is_finite = true;
  int culprit = -1;  // body of the first state that is not finite
};

inline void count_step(IslandBooks& books, double duration) {
  ++books.num_steps;
  if (books.least_step <= 0 || duration < books.least_step) books.least_step = duration;
}

/// Notes a body whose state is no longer a number.
inline void check_finite(const BodyState& body, IslandBooks& books) {
  if (body.velocity.allFinite() && body.angular_momentum.allFinite()) return;
  if (books.is_finite) books.culprit = body.index;
  books.is_finite = false;
}

struct LocalPair {
  int a = 0, b = 0;  // in Island::bodies
  ContactPair pair;
  double factor = 0;  // of the damping of its law, at the settings' steps per contact
  double moved = -1;  // m, bound of the motion since the last look of method xpbd; < 0: none yet
};

/// A line of an island; see tethers.h.
struct Tether {
  int index = -1;      // in the world
  int a = -1, b = -1;  // in Island::bodies; b < 0: held by the world
  Eigen::Vector3d attach_b = Eigen::Vector3d::Zero();  // m, frame of body a
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();    // m, world or frame of body b
  double length = 0;                                   // m; 0: a ball joint
  double tension = 0;                                  // N, of the last step
  bool is_taut = false;
};

struct Island {
  std::vector<BodyState> bodies;  // free ones first in world order, then what they may touch
  std::vector<LocalPair> pairs;   // in order of ContactPair::key
  std::vector<Tether> tethers;    // in the order of the world
  IslandBooks books;
  double time = 0;  // s
  int num_free = 0;
  bool has_forces = false;  // BodyState::force and the like are those of the present state
};

/// So many bodies that what each does within a step shows less than that they do not overlap.
inline bool is_crowd(const Island& island) { return island.num_free >= 6; }

// Pairs with less restitution rebound out of sight: their impacts are steps like any other.
constexpr double kPlastic = 0.05;
// Restitution from where an impact needs its own steps wherever it is: energy lost would be seen.
constexpr double kElastic = 0.9;

/// So many bodies that their impacts are not followed one by one.
inline bool is_throng(const Island& island) { return island.num_free >= 20; }

/// True if impacts of the pair take explicit steps. In a throng they have Newton's restitution
/// within an implicit step instead.
inline bool has_stepped_impacts(const Island& island, const PairLaw& law) {
  return law.restitution >= (is_throng(island) ? kElastic : kPlastic);
}

/// Advances to `end` (s). Impacts by explicit steps that begin at touch-down, rest by implicit
/// ones, free flight exactly.
void advance_island(Island& island, double end, const ContactSettings& settings);

}  // namespace verisim::dem
