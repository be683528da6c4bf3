// SPDX-License-Identifier: MIT
// Bounds the distance outside the grid from its value at the border.
#include "dem/distance_field.h"

#include <cmath>

namespace verisim::dem {

DistanceValue distance_outside_grid(const DistanceField& field, const Eigen::Vector3d& p_b) {
  // c is the point of the grid's box nearest to p. The body lies in that convex box, so for any of
  // its points s the angle at c is at least a right one: |p - s|^2 >= |p - c|^2 + |c - s|^2.
  // The square of a distance less |x|^2 is concave (a minimum of linear functions), so with v
  // interpolated between nodes, distance(c)^2 >= v^2 - spacing^2 sum t (1 - t); on the border of
  // the box one of the three t (1 - t) is 0 and the others are at most 1/4.
  Eigen::Vector3d c;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = field.origin_b[axis];
    const int num_cells = field.counts[axis] - 1;
    // fmax and fmin drop what is no number.
    c[axis] = std::fmin(std::fmax(p_b[axis], low), low + field.spacing * num_cells);
    // Rounding must not leave c outside the grid.
    while ((c[axis] - low) * (1 / field.spacing) > num_cells)
      c[axis] = std::nextafter(c[axis], low);
  }
  const Eigen::Vector3d beyond = p_b - c;
  const DistanceValue border = distance_at(field, c);
  const double squared =
      beyond.squaredNorm() + border.value * border.value - 0.5 * field.spacing * field.spacing;
  if (squared <= 0) return {0, Eigen::Vector3d::Zero()};
  const double value = std::sqrt(squared);
  // Along an axis on which p lies beyond the box, c stands still; along the others it follows p.
  Eigen::Vector3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    gradient[axis] =
        beyond[axis] != 0 ? beyond[axis] / value : border.value * border.gradient[axis] / value;
  }
  return {value, gradient};
}

}  // namespace verisim::dem
