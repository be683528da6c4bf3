// SPDX-License-Identifier: MIT
#include "dem/block_matrix.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <set>

#include "dem/block_kernel.h"

namespace verisim::dem {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

double dot(const std::vector<Vector6>& x, const std::vector<Vector6>& y) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += x[i].dot(y[i]);
  return sum;
}

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

void eliminate_plain(const BlockFactor& factor) { eliminate_inline(factor); }
void substitute_plain(const BlockFactor& factor, Vector6* x) { substitute_inline(factor, x); }
#if defined(__x86_64__)
__attribute__((target("avx2"))) void eliminate_avx2(const BlockFactor& factor) {
  eliminate_inline(factor);
}
__attribute__((target("avx2"))) void substitute_avx2(const BlockFactor& factor, Vector6* x) {
  substitute_inline(factor, x);
}
const bool kHasAvx2 = __builtin_cpu_supports("avx2");
#else
constexpr bool kHasAvx2 = false;
constexpr auto eliminate_avx2 = eliminate_plain;
constexpr auto substitute_avx2 = substitute_plain;
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
  std::vector<std::set<int>> rows(at(n));  // per column, positions below the diagonal
  for (const BlockMatrix::Edge& edge : edges_) {
    const int i = place_[at(edge.row)], j = place_[at(edge.column)];
    rows[at(std::min(i, j))].insert(std::max(i, j));
  }
  // The fill of a column goes on to its parent in the elimination tree (George and Liu 1981).
  for (int j = 0; j < n; ++j) {
    if (rows[at(j)].size() < 2) continue;
    const int parent = *rows[at(j)].begin();
    rows[at(parent)].insert(std::next(rows[at(j)].begin()), rows[at(j)].end());
  }
  columns_.assign(at(n), {});
  rows_.clear();
  for (int j = 0; j < n; ++j) {
    columns_[at(j)] = {static_cast<int>(rows_.size()), static_cast<int>(rows[at(j)].size())};
    rows_.insert(rows_.end(), rows[at(j)].begin(), rows[at(j)].end());
  }
  blocks_.resize(rows_.size());
  diagonal_.resize(at(n));
  targets_.clear();
  num_block_products_ = n;
  for (int j = 0; j < n; ++j) {
    const BlockFactor::Column& c = columns_[at(j)];
    num_block_products_ += c.count;
    for (int s = 0; s < c.count; ++s) {
      const int column = rows_[at(c.first + s)];
      targets_.push_back(~column);
      for (int t = s + 1; t < c.count; ++t) {
        targets_.push_back(block_at(rows_[at(c.first + t)], column));
      }
    }
  }
  num_block_products_ += static_cast<double>(targets_.size());
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

void BlockGradients::prepare(const BlockMatrix& matrix) {
  const std::size_t n = matrix.diagonal.size();
  inverse_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    inverse_[i] = Eigen::LLT<Matrix6>(matrix.diagonal[i]).solve(Matrix6::Identity());
  }
  first_lower_.assign(n + 1, 0);
  first_upper_.assign(n + 1, 0);
  for (const BlockMatrix::Edge& edge : matrix.edges) {
    ++first_lower_[at(edge.row) + 1];
    ++first_upper_[at(edge.column) + 1];
  }
  for (std::size_t i = 0; i < n; ++i) {
    first_lower_[i + 1] += first_lower_[i];
    first_upper_[i + 1] += first_upper_[i];
  }
  lower_.resize(matrix.edges.size());
  upper_.resize(matrix.edges.size());
  std::vector<int> next_lower = first_lower_, next_upper = first_upper_;
  for (int e = 0; e < static_cast<int>(matrix.edges.size()); ++e) {
    lower_[at(next_lower[at(matrix.edges[at(e)].row)]++)] = e;
    upper_[at(next_upper[at(matrix.edges[at(e)].column)]++)] = e;
  }
}

/// z = (D + U)^-1 D (D + L)^-1 r: one forward and one backward sweep.
void BlockGradients::precondition(const BlockMatrix& matrix, const std::vector<Vector6>& r,
                                  std::vector<Vector6>& z) {
  const int n = matrix.size();
  y_.resize(at(n));
  z.resize(at(n));
  for (int i = 0; i < n; ++i) {
    Vector6 sum = r[at(i)];
    for (int s = first_lower_[at(i)]; s < first_lower_[at(i) + 1]; ++s) {
      const int e = lower_[at(s)];
      sum.noalias() -= matrix.off[at(e)] * y_[at(matrix.edges[at(e)].column)];
    }
    y_[at(i)].noalias() = inverse_[at(i)] * sum;
  }
  for (int i = n - 1; i >= 0; --i) {
    Vector6 sum = Vector6::Zero();
    for (int s = first_upper_[at(i)]; s < first_upper_[at(i) + 1]; ++s) {
      const int e = upper_[at(s)];
      sum.noalias() += matrix.off[at(e)].transpose() * z[at(matrix.edges[at(e)].row)];
    }
    z[at(i)] = y_[at(i)] - inverse_[at(i)] * sum;
  }
}

int BlockGradients::solve(const BlockMatrix& matrix, const std::vector<Vector6>& b,
                          double tolerance, int most, std::vector<Vector6>& x) {
  prepare(matrix);
  x.assign(b.size(), Vector6::Zero());
  r_ = b;
  precondition(matrix, r_, z_);
  const double start = dot(r_, z_);
  if (!(start > 0)) return 0;
  p_ = z_;
  double rho = start;
  int iterations = 0;
  while (iterations < most && rho > tolerance * tolerance * start) {
    ++iterations;
    matrix.multiply(p_, ap_);
    const double step = rho / dot(p_, ap_);
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] += step * p_[i];
      r_[i] -= step * ap_[i];
    }
    precondition(matrix, r_, z_);
    const double next = dot(r_, z_);
    const double share = next / rho;
    for (std::size_t i = 0; i < x.size(); ++i) p_[i] = z_[i] + share * p_[i];
    rho = next;
  }
  return iterations;
}

}  // namespace verisim::dem
