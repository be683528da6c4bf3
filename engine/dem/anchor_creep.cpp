// SPDX-License-Identifier: MIT
#include "dem/anchor_creep.h"

#include <algorithm>

namespace verisim::dem {
namespace {

using Eigen::Vector3d;

void grip_anew(ContactPoint& point, const BodyState& a, const BodyState& b) {
  point.anchor.a = a.to_body(point.place);
  point.anchor.b = b.to_body(point.place);
  point.anchor.stretch_b = point.stretch_b;
  point.anchor.holds = point.is_touching;
  point.has_slid = false;
}

}  // namespace

double follow_anchors(ContactPair& pair, const BodyState& a, const BodyState& b) {
  if (std::holds_alternative<SphereShape>(*a.shape)) return 0;
  double longest = 0;
  for (ContactPoint& point : pair.points) {
    if (!point.is_touching || point.has_slid || !point.anchor.holds) {
      grip_anew(point, a, b);
      continue;
    }
    const Vector3d apart = a.position + a.rotation * point.anchor.a - b.position -
                           b.rotation * point.anchor.b -
                           b.rotation * (point.stretch_b - point.anchor.stretch_b);
    const Vector3d across = apart - point.normal.dot(apart) * point.normal;
    longest = std::max(longest, across.norm());
  }
  return longest;
}

}  // namespace verisim::dem
