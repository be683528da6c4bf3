// SPDX-License-Identifier: MIT
// Signed distance to a body's surface, interpolated from a grid in the body frame.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace verisim::dem {

/// Node (i, j, k) lies at origin_b + spacing (i, j, k); x runs fastest in `values`.
struct DistanceField {
  Eigen::Vector3d origin_b = Eigen::Vector3d::Zero();  // m, lowest node
  double spacing = 0;                                  // m, edge of a cell
  std::array<int, 3> counts{};                         // nodes per axis, each >= 2
  std::vector<float> values;                           // m, negative inside the body

  bool is_empty() const { return values.empty(); }
};

struct DistanceValue {
  double value;              // m, negative inside
  Eigen::Vector3d gradient;  // exact derivative of `value`; about, not exactly, of length 1
};

/// A lower bound of the distance at points outside the grid; see distance_at.
DistanceValue distance_outside_grid(const DistanceField& field, const Eigen::Vector3d& p_b);

/// Distance at `p_b` (m, body frame). Within the grid: the trilinear interpolant and its own exact
/// gradient, so that a force along it has a potential; the gradient jumps from cell to cell by
/// O(spacing * curvature). Outside the grid: a lower bound of the true distance (which lies up to
/// a quarter of the spacing below the interpolant at the border of the grid) and its gradient.
inline DistanceValue distance_at(const DistanceField& field, const Eigen::Vector3d& p_b) {
  const double inverse = 1 / field.spacing;
  const double u = (p_b.x() - field.origin_b.x()) * inverse;
  const double v = (p_b.y() - field.origin_b.y()) * inverse;
  const double w = (p_b.z() - field.origin_b.z()) * inverse;
  const auto [nx, ny, nz] = field.counts;
  // Written so that a point that is no number counts as outside.
  if (!(u >= 0 && v >= 0 && w >= 0 && u <= nx - 1 && v <= ny - 1 && w <= nz - 1)) {
    return distance_outside_grid(field, p_b);
  }
  const int i = std::min(static_cast<int>(u), nx - 2);
  const int j = std::min(static_cast<int>(v), ny - 2);
  const int k = std::min(static_cast<int>(w), nz - 2);
  const double x = u - i, y = v - j, z = w - k;
  const std::size_t row = static_cast<std::size_t>(nx);
  const std::size_t layer = row * static_cast<std::size_t>(ny);
  const float* at = field.values.data() + static_cast<std::size_t>(k) * layer +
                    static_cast<std::size_t>(j) * row + static_cast<std::size_t>(i);
  const double f000 = at[0], f100 = at[1];
  const double f010 = at[row], f110 = at[row + 1];
  const double f001 = at[layer], f101 = at[layer + 1];
  const double f011 = at[layer + row], f111 = at[layer + row + 1];
  // Along x, then y, then z; d.. are the differences along x, carried through the other two.
  const double d00 = f100 - f000, d10 = f110 - f010, d01 = f101 - f001, d11 = f111 - f011;
  const double f00 = f000 + x * d00, f10 = f010 + x * d10;
  const double f01 = f001 + x * d01, f11 = f011 + x * d11;
  const double f0 = f00 + y * (f10 - f00), f1 = f01 + y * (f11 - f01);
  const double d0 = d00 + y * (d10 - d00), d1 = d01 + y * (d11 - d01);
  const double slope_y = (f10 - f00) + z * ((f11 - f01) - (f10 - f00));
  return {f0 + z * (f1 - f0),
          {inverse * (d0 + z * (d1 - d0)), inverse * slope_y, inverse * (f1 - f0)}};
}

}  // namespace verisim::dem
