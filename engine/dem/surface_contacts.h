// SPDX-License-Identifier: MIT
// Methods `dem` and `xpbd`: all bodies as surfaces, pair by pair, island by island.
#pragma once

#include <vector>

#include "dem/hardest_contact.h"
#include "dem/island.h"
#include "dem/world.h"

namespace verisim::dem {

/// What was chosen for a world, and what it promises.
struct Chosen {
  double max_penetration = 0;  // m, allowed
  double rest_depth = 0;       // m, of a spring under its resting load
};

class SurfaceContacts {
 public:
  explicit SurfaceContacts(const WorldDefinition& definition);

  /// Advances all bodies by a frame of parameters.dt; the books take what it did.
  StepReport step(World& world);
  /// Takes over gravity and stiffness that were changed.
  void take_parameters(const World& world);

  const std::vector<ContactPair>& pairs() const { return pairs_; }
  const ContactSettings& settings() const { return settings_; }
  Chosen chosen() const { return chosen_; }
  double elastic_energy() const { return elastic_energy_; }
  double least_step() const { return least_step_; }
  const WorkSplit& work() const { return work_; }
  double largest_energy_rise() const { return energy_rise_; }
  double implicit_work() const { return implicit_work_; }
  double correction_work() const { return correction_work_; }
  double anchor_creep() const { return anchor_creep_; }
  long num_samples() const { return num_samples_; }

  // Between two steps (surface_look.cpp).
  /// The pairs that overlap now, with their points; changes nothing.
  std::vector<ContactPair> look(const World& world) const;
  /// The stiffest spring of the last step and how deep its pairs should go.
  HardestContact hardest_contact() const;
  const CollisionShape& shape(int body) const { return shapes_[static_cast<std::size_t>(body)]; }

 private:
  struct Bounds {
    Eigen::Vector3d low, high;  // m
  };
  /// Kept for its memory alone: a frame like the last one allocates nothing.
  struct Scratch {
    std::vector<std::uint64_t> keys;                // of pairs
    std::vector<int> order;                         // of bodies in a sweep
    std::vector<int> parents, island_of, local_of;  // [B + P]
    std::vector<std::size_t> num_pairs;             // of each island
    std::vector<Eigen::Vector3d> pushes;            // [B + P] m, way of what left its bounds
  };
  void load_bodies(const World& world);
  void store_bodies(World& world) const;
  Bounds bounds_over(const BodyState& body, double duration) const;
  PairLaw law_of(int a, int b) const;
  void add_pairs();
  bool add_missed_pairs();
  void pass_on_pushes();
  void make_islands(double time);
  void add_pairs_to_islands();
  void advance(Island& island, double end) const;
  double piece_of(double longest) const;
  double advance_islands(World& world, double start, double end);
  void take_back(double time);
  void book_islands(Balance& balance, StepReport& report);
  void take_events(std::vector<ContactEvent>& events) const;

  ContactSettings settings_;
  Chosen chosen_;
  MaterialPairs materials_;
  std::vector<CollisionShape> shapes_;                // [B + P]
  std::vector<int> material_;                         // [B + P]
  std::vector<PrescribedMotion> paths_;               // [B]
  std::vector<std::vector<DragPatch>> drag_patches_;  // [B]
  std::vector<BodyState> bodies_;                     // [B + P], at the start of the frame
  std::vector<Tether> tethers_;                       // between bodies of bodies_
  std::vector<ContactPair> pairs_;  // in order of their keys, at the start of the frame
  std::vector<Bounds> bounds_;      // [B + P], over the frame
  std::vector<Island> islands_;     // of the frame
  Scratch scratch_;
  std::vector<double> factor_of_law_;  // [M * M] calibrated damping of each pair of materials
  double elastic_energy_ = 0, least_step_ = 0, energy_rise_ = 0, anchor_creep_ = 0,
         implicit_work_ = 0, correction_work_ = 0;
  long num_samples_ = 0;
  WorkSplit work_;
};

StepReport step_surfaces(World& world);
/// Takes energies and momenta of the present state to the books.
void book_surfaces(World& world);

}  // namespace verisim::dem
