// SPDX-License-Identifier: MIT
// What can be asked of method `dem` between two steps.
#include <algorithm>
#include <cmath>

#include "dem/contact_tracking.h"
#include "dem/surface_contacts.h"

namespace verisim::dem {
namespace {

// A spring this close to what its load asks for was set by it.
constexpr double kSetByLoad = 0.9;

}  // namespace

std::vector<ContactPair> SurfaceContacts::look(const World& world) const {
  // A copy does it: a look must not change what the next step starts from.
  SurfaceContacts now = *this;
  now.load_bodies(world);
  now.bounds_.clear();
  for (const BodyState& body : now.bodies_) now.bounds_.push_back(now.bounds_over(body, 0));
  now.add_pairs();
  for (ContactPair& pair : now.pairs_) {
    LocalPair local;
    local.a = pair.a;
    local.b = pair.b;
    local.pair = std::move(pair);
    look_at(local, now.bodies_, 0);
    pair = std::move(local.pair);
  }
  return now.pairs_;
}

HardestContact SurfaceContacts::hardest_contact() const {
  HardestContact hardest;
  for (const ContactPair& pair : pairs_) {
    if (!(pair.stiffness > 0)) continue;
    const double mass = 1 / inverse_pair_mass(bodies_[static_cast<std::size_t>(pair.a)],
                                              bodies_[static_cast<std::size_t>(pair.b)]);
    const double in_impact = pair.approach_speed * std::sqrt(mass / pair.stiffness);
    const double load = std::max(pair.mean_load, mass * settings_.gravity.norm());
    const bool is_by_load = load >= kSetByLoad * pair.stiffness * settings_.rest_depth;
    StiffnessBound bound = is_by_load ? StiffnessBound::kLoad : StiffnessBound::kImpact;
    if (settings_.stiffness > 0) bound = StiffnessBound::kNamed;
    hardest.include({pair.stiffness, std::max(in_impact, load / pair.stiffness), bound});
  }
  return hardest;
}

}  // namespace verisim::dem
