// SPDX-License-Identifier: MIT
#include "dem/xpbd_contacts.h"

#include <algorithm>
#include <limits>

#include "dem/contact_tracking.h"

namespace verisim::dem {

double look_gap(const ContactSettings& settings) {
  const double g = settings.gravity.norm(), speed = settings.restitution_threshold;
  return std::max(2 * touch_gap(settings), g > 0 ? 0.5 * speed * speed / g : 0);
}

void begin_touching(LocalPair& local, Island& island, double speed) {
  local.pair.is_touching = true;
  local.pair.approach_speed = speed;
  record_event(island, local, ContactChange::kBegin, speed);
}

void update_touching(LocalPair& local, Island& island, const ContactSettings& settings) {
  ContactPair& pair = local.pair;
  const double touch = touch_gap(settings), threshold = settings.restitution_threshold;
  double deepest = -std::numeric_limits<double>::infinity(), fastest = deepest, parting = 0;
  for (const ContactPoint& point : pair.points) {
    const double speed = closing_speed(local, island.bodies, point);
    if (point.depth > deepest) {
      deepest = point.depth;
      parting = -speed;
    }
    if (point.depth >= -touch) fastest = std::max(fastest, speed);
  }
  const bool has_met = deepest >= -touch;
  if (!pair.is_touching) {
    const bool stays = fastest > -threshold || deepest > touch;
    if (has_met && stays) begin_touching(local, island, std::max(fastest, 0.0));
    return;
  }
  const bool leaves =
      has_met ? -fastest > threshold && deepest <= touch
              : parting > threshold || -deepest > look_gap(settings) || pair.points.empty();
  if (!leaves) return;
  pair.is_touching = false;
  for (ContactPoint& point : pair.points) {
    point.stretch_b.setZero();
    point.load = 0;
    point.is_touching = false;
  }
  record_event(island, local, ContactChange::kEnd, parting);
}

}  // namespace verisim::dem
