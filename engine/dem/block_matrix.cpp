// SPDX-License-Identifier: MIT
#include "dem/block_matrix.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

#include "dem/block_kernel.h"

namespace verisim::dem {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Positions of the bodies in an order of little fill.
std::vector<int> minimum_degree_order(int n, const std::vector<BlockMatrix::Edge>& edges) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 1.0);
  for (const BlockMatrix::Edge& edge : edges) {
    entries.emplace_back(edge.row, edge.column, 1.0);
    entries.emplace_back(edge.column, edge.row, 1.0);
  }
  Eigen::SparseMatrix<double> graph(n, n);
  graph.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(graph, order);
  // order.indices()[k] is the body eliminated k-th.
  std::vector<int> place(at(n));
  for (int k = 0; k < n; ++k) place[at(order.indices()[k])] = k;
  return place;
}

VERISIM_INLINE void eliminate_inline(const BlockFactor& factor) {
  const int* target = factor.targets;
  for (int j = 0; j < factor.size; ++j) {
    const BlockFactor::Column& c = factor.columns[j];
    Matrix6& pivot = factor.diagonal[j];
    invert_factor(Matrix6(pivot), pivot);
    for (int s = c.first; s < c.first + c.count; ++s) {
      if (factor.is_filled[s] != 0) multiply_by_transposed(pivot, factor.blocks[s]);
    }
    for (int s = c.first; s < c.first + c.count; ++s) {
      const int* const updates = target;
      target += c.first + c.count - s;
      if (factor.is_filled[s] == 0) continue;
      subtract_product(factor.blocks[s], factor.blocks[s], factor.diagonal[~updates[0]]);
      for (int t = s + 1; t < c.first + c.count; ++t) {
        if (factor.is_filled[t] == 0) continue;
        subtract_product(factor.blocks[t], factor.blocks[s], factor.blocks[updates[t - s]]);
        factor.is_filled[updates[t - s]] = 1;
      }
    }
  }
}

VERISIM_INLINE void substitute_inline(const BlockFactor& factor, Vector6* x) {
  for (int j = 0; j < factor.size; ++j) {
    multiply(factor.diagonal[j], x[j]);
    const BlockFactor::Column& c = factor.columns[j];
    for (int s = c.first; s < c.first + c.count; ++s) {
      if (factor.is_filled[s] == 0) continue;
      subtract_times(factor.blocks[s], x[j], x[factor.rows[s]]);
    }
  }
  for (int j = factor.size - 1; j >= 0; --j) {
    const BlockFactor::Column& c = factor.columns[j];
    for (int s = c.first; s < c.first + c.count; ++s) {
      if (factor.is_filled[s] == 0) continue;
      subtract_transposed_times(factor.blocks[s], x[factor.rows[s]], x[j]);
    }
    multiply_transposed(factor.diagonal[j], x[j]);
  }
}

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
void eliminate_plain(const BlockFactor& factor) { eliminate_inline(factor); }
void substitute_plain(const BlockFactor& factor, Vector6* x) { substitute_inline(factor, x); }
#if defined(__x86_64__)
__attribute__((target("avx2"))) void eliminate_avx2(const BlockFactor& factor) {
  eliminate_inline(factor);
}
__attribute__((target("avx2"))) void substitute_avx2(const BlockFactor& factor, Vector6* x) {
  substitute_inline(factor, x);
}
__attribute__((target("avx2"))) int descend_avx2(Rows& rows, double tolerance, int most,
                                                 BlockGradients::Vectors& v) {
  return descend_inline(rows, tolerance, most, v);
}
#else
constexpr auto eliminate_avx2 = eliminate_plain;
constexpr auto substitute_avx2 = substitute_plain;
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

void BlockCholesky::start_series() { is_first_ = true; }

void BlockCholesky::analyse(const BlockMatrix& matrix) {
  bool is_covered = !is_first_;
  for (std::size_t e = 0; e < matrix.edges.size() && is_covered; ++e) {
    is_covered = block_of_edge_[e] >= 0 || matrix.off[e].isZero(0);
  }
  if (is_covered) return;
  std::vector<BlockMatrix::Edge> edges;
  for (std::size_t e = 0; e < matrix.edges.size(); ++e) {
    const bool is_known = !is_first_ && block_of_edge_[e] >= 0;
    if (is_known || !matrix.off[e].isZero(0)) edges.push_back(matrix.edges[e]);
  }
  std::sort(edges.begin(), edges.end());
  is_first_ = false;
  if (static_cast<int>(place_.size()) != matrix.size() || edges != edges_) {
    edges_ = edges;
    find_order(matrix.size());
  }
  locate(matrix);
}

int BlockCholesky::block_at(int row, int column) const {
  const BlockFactor::Column& c = columns_[at(column)];
  const auto begin = rows_.begin() + c.first;
  return static_cast<int>(std::lower_bound(begin, begin + c.count, row) - rows_.begin());
}

/// Where the matrix's edges lie in the factor.
void BlockCholesky::locate(const BlockMatrix& matrix) {
  block_of_edge_.clear();
  edge_is_transposed_.clear();
  for (const BlockMatrix::Edge& edge : matrix.edges) {
    const int i = place_[at(edge.row)], j = place_[at(edge.column)];
    const bool is_covered = std::binary_search(edges_.begin(), edges_.end(), edge);
    block_of_edge_.push_back(is_covered ? block_at(std::max(i, j), std::min(i, j)) : -1);
    edge_is_transposed_.push_back(i < j);
  }
}

void BlockCholesky::find_order(int n) {
  place_ = minimum_degree_order(n, edges_);
  body_.resize(at(n));
  for (int b = 0; b < n; ++b) body_[at(place_[at(b)])] = b;
  std::vector<std::vector<int>> rows(at(n));  // per column, positions below the diagonal
  for (const BlockMatrix::Edge& edge : edges_) {
    const int i = place_[at(edge.row)], j = place_[at(edge.column)];
    rows[at(std::min(i, j))].push_back(std::max(i, j));
  }
  // The fill of a column goes on to its parent in the elimination tree (George and Liu 1981).
  num_block_products_ = n;
  for (std::vector<int>& column : rows) {
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    const double count = static_cast<double>(column.size());
    num_block_products_ += 2 * count + 0.5 * count * (count - 1);
    if (column.size() < 2) continue;
    std::vector<int>& parent = rows[at(column.front())];
    parent.insert(parent.end(), column.begin() + 1, column.end());
  }
  columns_.assign(at(n), {});
  rows_.clear();
  for (int j = 0; j < n; ++j) {
    columns_[at(j)] = {static_cast<int>(rows_.size()), static_cast<int>(rows[at(j)].size())};
    rows_.insert(rows_.end(), rows[at(j)].begin(), rows[at(j)].end());
  }
  targets_.clear();
}

/// The block that every update of the elimination goes to.
void BlockCholesky::find_targets() {
  const int n = static_cast<int>(columns_.size());
  blocks_.resize(rows_.size());
  diagonal_.resize(at(n));
  std::vector<int> block_in_column(at(n));
  for (int j = 0; j < n; ++j) {
    const BlockFactor::Column& c = columns_[at(j)];
    for (int s = 0; s < c.count; ++s) {
      const int column = rows_[at(c.first + s)];
      targets_.push_back(~column);
      if (s + 1 == c.count) continue;
      const BlockFactor::Column& target = columns_[at(column)];
      for (int k = target.first; k < target.first + target.count; ++k) {
        block_in_column[at(rows_[at(k)])] = k;
      }
      for (int t = s + 1; t < c.count; ++t) {
        targets_.push_back(block_in_column[at(rows_[at(c.first + t)])]);
      }
    }
  }
}

BlockFactor BlockCholesky::view() {
  BlockFactor factor;
  factor.size = static_cast<int>(diagonal_.size());
  factor.columns = columns_.data();
  factor.rows = rows_.data();
  factor.targets = targets_.data();
  factor.blocks = blocks_.data();
  factor.is_filled = is_filled_.data();
  factor.diagonal = diagonal_.data();
  return factor;
}

void BlockCholesky::factorise(const BlockMatrix& matrix) {
  if (targets_.empty()) find_targets();
  for (Matrix6& block : blocks_) block.setZero();
  for (int j = 0; j < matrix.size(); ++j) diagonal_[at(j)] = matrix.diagonal[at(body_[at(j)])];
  is_filled_.assign(blocks_.size(), 0);
  for (std::size_t e = 0; e < matrix.edges.size(); ++e) {
    if (matrix.off[e].isZero(0)) continue;  // bodies near each other that do not touch
    is_filled_[at(block_of_edge_[e])] = 1;
    Matrix6& block = blocks_[at(block_of_edge_[e])];
    if (edge_is_transposed_[e]) {
      block = matrix.off[e].transpose();
    } else {
      block = matrix.off[e];
    }
  }
  (kHasAvx2 ? eliminate_avx2 : eliminate_plain)(view());
}

void BlockCholesky::solve(const std::vector<Vector6>& b, std::vector<Vector6>& x) {
  const std::size_t n = diagonal_.size();
  work_.resize(n);
  for (std::size_t j = 0; j < n; ++j) work_[j] = b[at(body_[j])];
  (kHasAvx2 ? substitute_avx2 : substitute_plain)(view(), work_.data());
  x.resize(n);
  for (std::size_t j = 0; j < n; ++j) x[at(body_[j])] = work_[j];
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
