// SPDX-License-Identifier: MIT
// Four doubles side by side: x, y, z and one more. For the contact loop, where it halves the time.
#pragma once

#include <Eigen/Core>

#define VERISIM_INLINE inline __attribute__((always_inline))

namespace verisim::dem {

// The compiler's own vector type: one register with AVX, two with SSE2, the same bits from both,
// because each operation is rounded by itself (no fused multiply-add; the build forbids it).
// The alignment must be said: without AVX the compiler would take 16, and 32 in the AVX2 loop.
using Lanes = double __attribute__((vector_size(32), aligned(32)));

// g++ warns, where they are called, that functions return such a value differently with AVX. All
// that do are inlined, so nothing is returned.
#pragma GCC diagnostic ignored "-Wpsabi"

VERISIM_INLINE Lanes to_lanes(const Eigen::Vector3d& v, double fourth = 0) {
  return Lanes{v.x(), v.y(), v.z(), fourth};
}

VERISIM_INLINE Eigen::Vector3d to_vector(const Lanes& v) { return {v[0], v[1], v[2]}; }

/// Of the first three lanes.
VERISIM_INLINE double dot(const Lanes& a, const Lanes& b) {
  const Lanes product = a * b;
  return product[0] + product[1] + product[2];
}

/// Of the first three lanes; the fourth is 0 for finite input.
VERISIM_INLINE Lanes cross(const Lanes& a, const Lanes& b) {
  const Lanes a_yzx = __builtin_shufflevector(a, a, 1, 2, 0, 3);
  const Lanes b_yzx = __builtin_shufflevector(b, b, 1, 2, 0, 3);
  const Lanes zxy = a * b_yzx - a_yzx * b;
  return __builtin_shufflevector(zxy, zxy, 1, 2, 0, 3);
}

}  // namespace verisim::dem
