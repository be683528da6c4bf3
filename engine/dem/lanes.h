// SPDX-License-Identifier: MIT
// Four doubles side by side: x, y, z and one more. For the contact loop, where it halves the time.
#pragma once

#include <Eigen/Core>

#define VERISIM_INLINE inline __attribute__((always_inline))

namespace verisim::dem {

/// Three components and one more value, as they lie in memory.
struct alignas(32) Quad {
  double x = 0, y = 0, z = 0, w = 0;

  Quad() = default;
  explicit Quad(const Eigen::Vector3d& v, double fourth = 0)
      : x(v.x()), y(v.y()), z(v.z()), w(fourth) {}
  Eigen::Vector3d vector() const { return {x, y, z}; }
  void add(const Eigen::Vector3d& v) {
    x += v.x();
    y += v.y();
    z += v.z();
  }
};

// The compiler's own vector type: one register with AVX2, two with SSE2, the same bits from both,
// because each operation is rounded by itself (no fused multiply-add; the build forbids it).
// Only for loops compiled for AVX2 too: SSE2 code that builds such values one by one is slow.
// The alignment must be said: without AVX the compiler would take 16, and 32 in the AVX2 loop.
using Lanes = double __attribute__((vector_size(32), aligned(32), may_alias));

// g++ warns, where they are called, that functions return such a value differently with AVX. All
// that do are inlined, so nothing is returned.
#pragma GCC diagnostic ignored "-Wpsabi"

// Loops of this kind are compiled twice; which one runs is known at the start.
#if defined(__x86_64__)
inline const bool kHasAvx2 = __builtin_cpu_supports("avx2");
#else
constexpr bool kHasAvx2 = false;
#endif

VERISIM_INLINE Lanes load(const Quad& quad) { return *reinterpret_cast<const Lanes*>(&quad); }
VERISIM_INLINE void store(Quad& quad, const Lanes& v) { *reinterpret_cast<Lanes*>(&quad) = v; }

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
