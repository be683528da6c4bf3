// SPDX-License-Identifier: MIT
// Cholesky factorisation of a symmetric matrix of 6x6 blocks.
#pragma once

#include <vector>

#include "dem/block_matrix.h"

namespace verisim::dem {

/// What the loops of a factorisation work on.
struct BlockFactor {
  struct Column {
    int first = 0, count = 0;  // in rows and blocks, below the diagonal
  };
  /// Columns begin to end - 1, each of which has the next one's position and its rows: the rows
  /// from `end` on are the same in all.
  struct Supernode {
    int begin = 0, end = 0;
    std::size_t first_target = 0;
  };
  int size;
  const Column* columns;  // [size]
  int num_supernodes;
  const Supernode* supernodes;
  const int* outer;    // [size] block of a column's first row from its supernode's end on
  const int* rows;     // positions, rising in a column
  const int* targets;  // index in blocks (or ~position of a diagonal) per update of a supernode
  Matrix6* blocks;
  Matrix6* diagonal;  // first A's, then the inverses of the Cholesky factors
};

/// Sparse block Cholesky factorisation A = L L^T with a fill-reducing (minimum degree) order.
/// Columns of equal rows are eliminated at once (supernodes: Ng and Peyton 1993).
class BlockCholesky {
 public:
  /// Matrices that follow have the same edges as each other. Order and fill depend on nothing that
  /// came before.
  void start_series();
  /// Makes order and fill cover all blocks of the series so far that were not zero.
  void analyse(const BlockMatrix& matrix);
  /// Multiplications of 6x6 blocks that one factorisation takes.
  double num_block_products() const { return num_block_products_; }
  /// Edges that order and fill cover.
  std::size_t num_edges() const { return edges_.size(); }
  void factorise(const BlockMatrix& matrix);
  /// x = A^-1 b; b and x may be the same.
  void solve(const std::vector<Vector6>& b, std::vector<Vector6>& x);

 private:
  void find_order(int size);
  void find_supernodes();
  void find_targets();
  void locate(const BlockMatrix& matrix);
  int block_at(int row, int column) const;
  BlockFactor view();
  std::vector<int> place_;  // [N] position of a body in the order
  std::vector<int> body_;   // [N] and back
  std::vector<BlockFactor::Column> columns_;
  std::vector<BlockFactor::Supernode> supernodes_;
  std::vector<int> outer_;
  std::vector<int> rows_;
  std::vector<Matrix6> blocks_;
  std::vector<Matrix6> diagonal_;
  std::vector<int> targets_;
  bool is_first_ = true;                  // of a series
  std::vector<BlockMatrix::Edge> edges_;  // covered, in rising order
  std::vector<int> block_of_edge_;        // [E] of the matrix; -1: not covered
  std::vector<bool> edge_is_transposed_;  // [E]
  double num_block_products_ = 0;
  std::vector<Vector6> work_;
};

}  // namespace verisim::dem
