// SPDX-License-Identifier: MIT
#include "dem/block_matrix.h"

#include "dem/block_kernel.h"

namespace verisim::dem {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

using Rows = BlockGradients::Rows;

VERISIM_INLINE void make_diagonal_one(Rows& rows) {
  const int n = static_cast<int>(rows.inverse_factor.size());
  for (int i = 0; i < n; ++i) {
    invert_factor(Matrix6(rows.inverse_factor[at(i)]), rows.inverse_factor[at(i)]);
    for (int s = rows.first[at(i)]; s < rows.first[at(i) + 1]; ++s) {
      multiply_by_transposed(rows.inverse_factor[at(rows.column[at(s)])], rows.off[at(s)]);
      multiply_from_left(rows.inverse_factor[at(i)], rows.off[at(s)]);
    }
  }
}

/// x <- (1 + L)^-1 x.
VERISIM_INLINE void sweep_forward(const Rows& rows, std::vector<Vector6>& x) {
  for (int i = 0; i < static_cast<int>(x.size()); ++i) {
    for (int s = rows.first[at(i)]; s < rows.first[at(i) + 1]; ++s) {
      subtract_times(rows.off[at(s)], x[at(rows.column[at(s)])], x[at(i)]);
    }
  }
}

/// x <- (1 + L^T)^-1 x.
VERISIM_INLINE void sweep_backward(const Rows& rows, std::vector<Vector6>& x) {
  for (int i = static_cast<int>(x.size()) - 1; i >= 0; --i) {
    for (int s = rows.first[at(i)]; s < rows.first[at(i) + 1]; ++s) {
      subtract_transposed_times(rows.off[at(s)], x[at(i)], x[at(rows.column[at(s)])]);
    }
  }
}

VERISIM_INLINE double dot_all(const std::vector<Vector6>& x, const std::vector<Vector6>& y) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += dot(load_six(x[i].data()), load_six(y[i].data()));
  }
  return sum;
}

/// y += scale x.
VERISIM_INLINE void add_all(const std::vector<Vector6>& x, double scale, std::vector<Vector6>& y) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    Six sum = load_six(y[i].data());
    add_scaled(load_six(x[i].data()), scale, sum);
    store_six(sum, y[i].data());
  }
}

/// From the right side in `v.r` to the solution in `v.x`: gradients of (1 + L)^-1 A (1 + L^T)^-1,
/// whose product with p is t + (1 + L)^-1 (p - t), t = (1 + L^T)^-1 p.
VERISIM_INLINE int descend_inline(Rows& rows, double tolerance, int most,
                                  BlockGradients::Vectors& v) {
  make_diagonal_one(rows);
  for (std::size_t i = 0; i < v.r.size(); ++i) multiply(rows.inverse_factor[i], v.r[i]);
  sweep_forward(rows, v.r);
  v.x.assign(v.r.size(), Vector6::Zero());
  v.p = v.r;
  const double start = dot_all(v.r, v.r);
  double rho = start;
  int iterations = 0;
  while (iterations < most && rho > tolerance * tolerance * start) {
    ++iterations;
    v.t = v.p;
    sweep_backward(rows, v.t);
    v.ap = v.p;
    add_all(v.t, -1, v.ap);
    sweep_forward(rows, v.ap);
    add_all(v.t, 1, v.ap);
    const double step = rho / dot_all(v.p, v.ap);
    add_all(v.p, step, v.x);
    add_all(v.ap, -step, v.r);
    const double next = dot_all(v.r, v.r);
    v.t = v.r;
    add_all(v.p, next / rho, v.t);
    v.p.swap(v.t);
    rho = next;
  }
  sweep_backward(rows, v.x);
  for (std::size_t i = 0; i < v.x.size(); ++i) multiply_transposed(rows.inverse_factor[i], v.x[i]);
  return iterations;
}

int descend_plain(Rows& rows, double tolerance, int most, BlockGradients::Vectors& v) {
  return descend_inline(rows, tolerance, most, v);
}
#if defined(__x86_64__)
__attribute__((target("avx2"))) int descend_avx2(Rows& rows, double tolerance, int most,
                                                 BlockGradients::Vectors& v) {
  return descend_inline(rows, tolerance, most, v);
}
#else
constexpr auto descend_avx2 = descend_plain;
#endif

}  // namespace

void BlockMatrix::multiply(const std::vector<Vector6>& x, std::vector<Vector6>& y) const {
  y.resize(x.size());
  for (std::size_t i = 0; i < diagonal.size(); ++i) y[i].noalias() = diagonal[i] * x[i];
  for (std::size_t e = 0; e < edges.size(); ++e) {
    y[at(edges[e].row)].noalias() += off[e] * x[at(edges[e].column)];
    y[at(edges[e].column)].noalias() += off[e].transpose() * x[at(edges[e].row)];
  }
}

/// The rows of L: blocks that are not zero.
void BlockGradients::take(const BlockMatrix& matrix) {
  const std::size_t n = matrix.diagonal.size();
  rows_.first.assign(n + 1, 0);
  for (std::size_t e = 0; e < matrix.edges.size(); ++e) {
    if (!matrix.off[e].isZero(0)) ++rows_.first[at(matrix.edges[e].row) + 1];
  }
  for (std::size_t i = 0; i < n; ++i) rows_.first[i + 1] += rows_.first[i];
  rows_.column.resize(at(rows_.first[n]));
  rows_.off.resize(at(rows_.first[n]));
  std::vector<int> next(rows_.first.begin(), rows_.first.end() - 1);
  for (std::size_t e = 0; e < matrix.edges.size(); ++e) {
    if (matrix.off[e].isZero(0)) continue;
    const int place = next[at(matrix.edges[e].row)]++;
    rows_.column[at(place)] = matrix.edges[e].column;
    rows_.off[at(place)] = matrix.off[e];
  }
  rows_.inverse_factor = matrix.diagonal;
}

int BlockGradients::solve(const BlockMatrix& matrix, const std::vector<Vector6>& b,
                          double tolerance, int most, std::vector<Vector6>& x) {
  take(matrix);
  vectors_.r = b;
  const int iterations =
      (kHasAvx2 ? descend_avx2 : descend_plain)(rows_, tolerance, most, vectors_);
  x = vectors_.x;
  return iterations;
}

}  // namespace verisim::dem
