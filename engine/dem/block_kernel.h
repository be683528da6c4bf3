// SPDX-License-Identifier: MIT
// Products of 6x6 blocks and vectors of six, four numbers at a time. Inlined into loops that are
// compiled for AVX2 too: the same bits from both.
#pragma once

#include <cmath>
#include <cstring>

#include "dem/block_matrix.h"
#include "dem/lanes.h"

namespace verisim::dem {

/// Six numbers: four and two.
struct Six {
  using Two = double __attribute__((vector_size(16), aligned(16), may_alias));
  Lanes four;
  Two two;
};

VERISIM_INLINE Six load_six(const double* numbers) {
  Six six;
  std::memcpy(&six.four, numbers, sizeof(six.four));
  std::memcpy(&six.two, numbers + 4, sizeof(six.two));
  return six;
}
VERISIM_INLINE void store_six(const Six& six, double* numbers) {
  std::memcpy(numbers, &six.four, sizeof(six.four));
  std::memcpy(numbers + 4, &six.two, sizeof(six.two));
}
VERISIM_INLINE void add_scaled(const Six& x, double scale, Six& sum) {
  sum.four += x.four * scale;
  sum.two += x.two * scale;
}
VERISIM_INLINE void subtract_scaled(const Six& x, double scale, Six& sum) {
  sum.four -= x.four * scale;
  sum.two -= x.two * scale;
}
VERISIM_INLINE double dot(const Six& x, const Six& y) {
  const Lanes four = x.four * y.four;
  const Six::Two two = x.two * y.two;
  return ((four[0] + four[2]) + two[0]) + ((four[1] + four[3]) + two[1]);
}
VERISIM_INLINE Six zero_six() { return {Lanes{0, 0, 0, 0}, Six::Two{0, 0}}; }

/// c -= sum a b^T over `count` pairs of blocks: those at a and b from each of `starts`. Rows 0 to 3
/// of a column are a register of their own, rows 4 and 5 share one with those of the next column.
VERISIM_INLINE void subtract_products(const Matrix6* blocks, const int* starts, int count, int a,
                                      int b, Matrix6& c) {
  using Two = Six::Two;
  Lanes upper[6], lower[3];
  const auto load_two = [](const double* numbers) {
    Two two;
    std::memcpy(&two, numbers, sizeof(two));
    return two;
  };
  for (int j = 0; j < 6; ++j) std::memcpy(&upper[j], c.data() + 6 * j, sizeof(Lanes));
  for (int j = 0; j < 3; ++j) {
    lower[j] = __builtin_shufflevector(load_two(c.data() + 12 * j + 4),
                                       load_two(c.data() + 12 * j + 10), 0, 1, 2, 3);
  }
  for (int i = 0; i < count; ++i) {
    const double* of_a = blocks[starts[i] + a].data();
    const double* of_b = blocks[starts[i] + b].data();
#pragma GCC unroll 1
    for (int k = 0; k < 6; ++k, of_a += 6, of_b += 6) {
      Lanes rows;
      std::memcpy(&rows, of_a, sizeof(rows));
      for (int j = 0; j < 6; ++j) upper[j] -= rows * of_b[j];
      const Two last = load_two(of_a + 4);
      const Lanes twice = __builtin_shufflevector(last, last, 0, 1, 0, 1);
      for (int j = 0; j < 3; ++j) {
        const Two pair = load_two(of_b + 2 * j);
        lower[j] -= twice * __builtin_shufflevector(pair, pair, 0, 0, 1, 1);
      }
    }
  }
  for (int j = 0; j < 6; ++j) std::memcpy(c.data() + 6 * j, &upper[j], sizeof(Lanes));
  for (int j = 0; j < 3; ++j) {
    std::memcpy(c.data() + 12 * j + 4, &lower[j], sizeof(Two));
    std::memcpy(c.data() + 12 * j + 10, reinterpret_cast<const char*>(&lower[j]) + sizeof(Two),
                sizeof(Two));
  }
}

/// a <- a l^T, l lower triangular.
VERISIM_INLINE void multiply_by_transposed(const Matrix6& l, Matrix6& a) {
  Six column[6];
  for (int k = 0; k < 6; ++k) column[k] = load_six(a.data() + 6 * k);
  for (int j = 0; j < 6; ++j) {
    Six sum = zero_six();
    for (int k = 0; k <= j; ++k) add_scaled(column[k], l.data()[6 * k + j], sum);
    store_six(sum, a.data() + 6 * j);
  }
}

/// y -= a x.
VERISIM_INLINE void subtract_times(const Matrix6& a, const Vector6& x, Vector6& y) {
  Six sum = load_six(y.data());
  for (int k = 0; k < 6; ++k) subtract_scaled(load_six(a.data() + 6 * k), x.data()[k], sum);
  store_six(sum, y.data());
}

/// y -= a^T x.
VERISIM_INLINE void subtract_transposed_times(const Matrix6& a, const Vector6& x, Vector6& y) {
  const Six of_x = load_six(x.data());
  for (int k = 0; k < 6; ++k) y.data()[k] -= dot(load_six(a.data() + 6 * k), of_x);
}

/// x <- a x.
VERISIM_INLINE void multiply(const Matrix6& a, Vector6& x) {
  Six sum = zero_six();
  for (int k = 0; k < 6; ++k) add_scaled(load_six(a.data() + 6 * k), x.data()[k], sum);
  store_six(sum, x.data());
}

/// a <- l a.
VERISIM_INLINE void multiply_from_left(const Matrix6& l, Matrix6& a) {
  Six column[6];
  for (int k = 0; k < 6; ++k) column[k] = load_six(l.data() + 6 * k);
  for (int j = 0; j < 6; ++j) {
    Six sum = zero_six();
    for (int k = 0; k < 6; ++k) add_scaled(column[k], a.data()[6 * j + k], sum);
    store_six(sum, a.data() + 6 * j);
  }
}

/// x <- a^T x.
VERISIM_INLINE void multiply_transposed(const Matrix6& a, Vector6& x) {
  const Six of_x = load_six(x.data());
  for (int k = 0; k < 6; ++k) x.data()[k] = dot(load_six(a.data() + 6 * k), of_x);
}

/// L^-1 of a = L L^T, of which the lower triangle is read; above the diagonal 0.
VERISIM_INLINE void invert_factor(const Matrix6& a, Matrix6& inverse) {
  double l[6][6], reciprocal[6];
  for (int j = 0; j < 6; ++j) {
    double pivot = a.data()[7 * j];
    for (int k = 0; k < j; ++k) pivot -= l[j][k] * l[j][k];
    l[j][j] = std::sqrt(pivot);
    reciprocal[j] = 1 / l[j][j];
    for (int i = j + 1; i < 6; ++i) {
      double sum = a.data()[6 * j + i];
      for (int k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
      l[i][j] = sum * reciprocal[j];
    }
  }
  for (int j = 0; j < 6; ++j) {
    for (int i = 0; i < j; ++i) inverse.data()[6 * j + i] = 0;
    inverse.data()[7 * j] = reciprocal[j];
    for (int i = j + 1; i < 6; ++i) {
      double sum = 0;
      for (int k = j; k < i; ++k) sum -= l[i][k] * inverse.data()[6 * j + k];
      inverse.data()[6 * j + i] = sum * reciprocal[i];
    }
  }
}

}  // namespace verisim::dem
