// SPDX-License-Identifier: MIT
#include "dem/tether_definition.h"

#include <cmath>
#include <sstream>

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

// A body may start this much too far from its anchor, as a share of its size and the line: numbers
// in a scene are rounded.
constexpr double kRounding = 1e-6;

Vector3d attach_of(const TetherDefinition& tether, const std::vector<BodyDefinition>& bodies) {
  const Pose& pose = bodies[static_cast<std::size_t>(tether.body)].initial;
  return pose.position + pose.orientation * tether.attach_b;
}

Vector3d anchor_of(const TetherDefinition& tether, const std::vector<BodyDefinition>& bodies) {
  if (tether.other < 0) return tether.anchor;
  const Pose& pose = bodies[static_cast<std::size_t>(tether.other)].initial;
  return pose.position + pose.orientation * tether.anchor;
}

}  // namespace

std::string fault_of_tether(const TetherDefinition& tether,
                            const std::vector<BodyDefinition>& bodies) {
  const int count = static_cast<int>(bodies.size());
  if (tether.body < 0 || tether.body >= count || tether.other >= count) return "no such body";
  const BodyDefinition& body = bodies[static_cast<std::size_t>(tether.body)];
  if (body.motion != Motion::kFree) return "body " + body.name + " does not move freely";
  if (tether.other == tether.body) return "both ends are on body " + body.name;
  if (tether.other >= 0) {
    const BodyDefinition& other = bodies[static_cast<std::size_t>(tether.other)];
    if (other.motion == Motion::kPrescribed) return "body " + other.name + " follows given poses";
  }
  if (!tether.attach_b.allFinite() || !tether.anchor.allFinite() || !std::isfinite(tether.length)) {
    return "a number is not finite";
  }
  const double span = (anchor_of(tether, bodies) - attach_of(tether, bodies)).norm();
  if (tether.length < 0 && !(span > 0)) return "no length, and its ends start in one place";
  if (tether.length >= 0 && span > tether.length + kRounding * (tether.length + body.size)) {
    std::ostringstream text;
    text << "length is " << tether.length << " m; its ends start " << span << " m apart";
    return text.str();
  }
  return {};
}

std::vector<Tether> make_tethers(const WorldDefinition& definition) {
  std::vector<Tether> tethers;
  for (const TetherDefinition& given : definition.tethers) {
    Tether tether;
    tether.index = static_cast<int>(tethers.size());
    tether.a = given.body;
    tether.b = given.other;
    tether.attach_b = given.attach_b;
    tether.anchor = given.anchor;
    const Vector3d attach = attach_of(given, definition.bodies);
    Vector3d anchor = anchor_of(given, definition.bodies);
    const double span = (anchor - attach).norm();
    tether.length = given.length < 0 ? span : given.length;
    tether.is_taut = span >= tether.length * (1 - kRounding);
    if (tether.is_taut && tether.length > 0) tether.length = span;
    if (!(tether.length > 0)) anchor = attach;
    if (given.other >= 0) {
      const BodyDefinition& other = definition.bodies[static_cast<std::size_t>(given.other)];
      if (other.motion != Motion::kFree) tether.b = -1;
      const Pose& pose = other.initial;
      tether.anchor =
          tether.b < 0 ? anchor : Vector3d(pose.orientation.conjugate() * (anchor - pose.position));
    } else {
      tether.anchor = anchor;
    }
    tethers.push_back(tether);
  }
  return tethers;
}

}  // namespace verisim::dem
