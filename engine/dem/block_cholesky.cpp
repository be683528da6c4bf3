// SPDX-License-Identifier: MIT
#include "dem/block_cholesky.h"

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

/// Elimination within supernode n: its columns, from what their predecessors leave of them.
VERISIM_INLINE void eliminate_columns(const BlockFactor& factor, const BlockFactor::Supernode& n) {
  const int* outer = factor.outer + n.begin;
  const int num_outer = factor.columns[n.end - 1].count;
  for (int j = n.begin; j < n.end; ++j) {
    const int done = j - n.begin, row = j - n.end;
    Matrix6& pivot = factor.diagonal[j];
    subtract_products(factor.blocks, outer, done, row, row, pivot);
    invert_factor(Matrix6(pivot), pivot);
    for (int i = row + 1; i < num_outer; ++i) {
      Matrix6& block = factor.blocks[factor.outer[j] + i];
      subtract_products(factor.blocks, outer, done, i, row, block);
      multiply_by_transposed(pivot, block);
    }
  }
}

VERISIM_INLINE void eliminate_inline(const BlockFactor& factor) {
  for (int k = 0; k < factor.num_supernodes; ++k) {
    const BlockFactor::Supernode& n = factor.supernodes[k];
    eliminate_columns(factor, n);
    const int* target = factor.targets + n.first_target;
    const int* outer = factor.outer + n.begin;
    const int num_outer = factor.columns[n.end - 1].count;
    for (int s = 0; s < num_outer; ++s) {
      Matrix6& diagonal = factor.diagonal[~*target++];
      subtract_products(factor.blocks, outer, n.end - n.begin, s, s, diagonal);
      for (int t = s + 1; t < num_outer; ++t) {
        subtract_products(factor.blocks, outer, n.end - n.begin, t, s, factor.blocks[*target++]);
      }
    }
  }
}

VERISIM_INLINE void substitute_inline(const BlockFactor& factor, Vector6* x) {
  for (int j = 0; j < factor.size; ++j) {
    multiply(factor.diagonal[j], x[j]);
    const BlockFactor::Column& c = factor.columns[j];
    for (int s = c.first; s < c.first + c.count; ++s) {
      subtract_times(factor.blocks[s], x[j], x[factor.rows[s]]);
    }
  }
  for (int j = factor.size - 1; j >= 0; --j) {
    const BlockFactor::Column& c = factor.columns[j];
    for (int s = c.first; s < c.first + c.count; ++s) {
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
#else
constexpr auto eliminate_avx2 = eliminate_plain;
constexpr auto substitute_avx2 = substitute_plain;
#endif

}  // namespace

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
  supernodes_.clear();
}

/// Neighbours in the order, the first of which has no rows but the second and its rows.
void BlockCholesky::find_supernodes() {
  const int n = static_cast<int>(columns_.size());
  outer_.resize(at(n));
  for (int j = 0; j < n; ++j) {
    const auto is_joined = [&] {
      const BlockFactor::Column& before = columns_[at(j - 1)];
      return before.count == columns_[at(j)].count + 1 && rows_[at(before.first)] == j;
    };
    if (j == 0 || !is_joined()) supernodes_.push_back({j, j, 0});
    supernodes_.back().end = j + 1;
  }
  for (const BlockFactor::Supernode& s : supernodes_) {
    for (int j = s.begin; j < s.end; ++j) outer_[at(j)] = columns_[at(j)].first + s.end - 1 - j;
  }
}

/// The block that every update of the elimination goes to.
void BlockCholesky::find_targets() {
  const std::size_t n = columns_.size();
  blocks_.resize(rows_.size());
  diagonal_.resize(n);
  targets_.clear();
  std::vector<int> block_in_column(n);
  for (BlockFactor::Supernode& supernode : supernodes_) {
    supernode.first_target = targets_.size();
    const BlockFactor::Column& c = columns_[at(supernode.end - 1)];
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
  factor.num_supernodes = static_cast<int>(supernodes_.size());
  factor.supernodes = supernodes_.data();
  factor.outer = outer_.data();
  factor.targets = targets_.data();
  factor.blocks = blocks_.data();
  factor.diagonal = diagonal_.data();
  return factor;
}

void BlockCholesky::factorise(const BlockMatrix& matrix) {
  if (supernodes_.empty()) {
    find_supernodes();
    find_targets();
  }
  for (Matrix6& block : blocks_) block.setZero();
  for (int j = 0; j < matrix.size(); ++j) diagonal_[at(j)] = matrix.diagonal[at(body_[at(j)])];
  for (std::size_t e = 0; e < matrix.edges.size(); ++e) {
    if (matrix.off[e].isZero(0)) continue;  // bodies near each other that do not touch
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

}  // namespace verisim::dem
