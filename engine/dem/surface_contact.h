// SPDX-License-Identifier: MIT
// Where two surfaces touch or nearly touch, for every pair of shapes.
#pragma once

#include <vector>

#include "dem/body_state.h"
#include "dem/contact_pair.h"

namespace verisim::dem {

/// A place where two surfaces overlap or are within the margin.
struct FoundPoint {
  std::uint64_t id;
  Eigen::Vector3d place;   // m, world
  Eigen::Vector3d normal;  // unit, pushes a away from b
  double depth;            // m, < 0 apart
  double weight;
};

/// What a look at two bodies found.
struct Found {
  std::vector<FoundPoint> points;
  double gap = 0;  // m, lower bound of the distance; < 0 where they overlap
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // of the closest place, b to a
  bool is_along_normal = true;                        // the shapes are separated along it by `gap`
  int axis = -1;
};

/// Finds the contact points of `a` and `b` no farther apart than `margin` (m). Boxes: corners of
/// the clipped common face, or the closest points of two edges. Meshes: surface points of each in
/// the distance field of the other. `last_axis` is Found::axis of the last look, -1 at first.
void find_points(const BodyState& a, const BodyState& b, double margin, int last_axis,
                 Found& found);

/// True if find_points takes (a, b) in this order; otherwise swap them.
bool is_in_order(const CollisionShape& a, const CollisionShape& b);

/// The same for two boxes (box_contact.cpp).
void find_box_points(const BodyState& a, const BodyState& b, double margin, int last_axis,
                     Found& found);

}  // namespace verisim::dem
