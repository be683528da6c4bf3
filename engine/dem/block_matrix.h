// SPDX-License-Identifier: MIT
// A symmetric matrix of 6x6 blocks, one row of blocks per body, and two ways to solve with it.
#pragma once

#include <Eigen/Core>
#include <compare>
#include <vector>

namespace verisim::dem {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Symmetric positive definite: blocks on the diagonal and below it, edges (row > column).
struct BlockMatrix {
  struct Edge {
    int row, column;
    auto operator<=>(const Edge&) const = default;
  };
  std::vector<Matrix6> diagonal;  // [N]
  std::vector<Edge> edges;        // [E] unique
  std::vector<Matrix6> off;       // [E] block (row, column)

  int size() const { return static_cast<int>(diagonal.size()); }
  /// y = A x.
  void multiply(const std::vector<Vector6>& x, std::vector<Vector6>& y) const;
};

/// What the loops of a factorisation work on.
struct BlockFactor {
  struct Column {
    int first = 0, count = 0;  // in rows and blocks, below the diagonal
  };
  int size;
  const Column* columns;  // [size]
  const int* rows;        // positions, rising in a column
  const int* targets;     // index in blocks (or ~position of a diagonal) per update
  Matrix6* blocks;
  char* is_filled;    // per block; the others are zero
  Matrix6* diagonal;  // first A's, then the inverses of the Cholesky factors
};

/// Sparse block Cholesky factorisation A = L L^T with a fill-reducing (minimum degree) order.
class BlockCholesky {
 public:
  /// Matrices that follow have the same edges as each other. Order and fill depend on nothing that
  /// came before.
  void start_series();
  /// Makes order and fill cover all blocks of the series so far that were not zero.
  void analyse(const BlockMatrix& matrix);
  /// Multiplications of 6x6 blocks that one factorisation takes at most.
  double num_block_products() const { return num_block_products_; }
  /// Edges that order and fill cover.
  std::size_t num_edges() const { return edges_.size(); }
  void factorise(const BlockMatrix& matrix);
  /// x = A^-1 b; b and x may be the same.
  void solve(const std::vector<Vector6>& b, std::vector<Vector6>& x);

 private:
  void find_order(int size);
  void find_targets();
  void locate(const BlockMatrix& matrix);
  int block_at(int row, int column) const;
  BlockFactor view();
  std::vector<int> place_;  // [N] position of a body in the order
  std::vector<int> body_;   // [N] and back
  std::vector<BlockFactor::Column> columns_;
  std::vector<int> rows_;
  std::vector<Matrix6> blocks_;
  std::vector<char> is_filled_;
  std::vector<Matrix6> diagonal_;
  std::vector<int> targets_;
  bool is_first_ = true;                  // of a series
  std::vector<BlockMatrix::Edge> edges_;  // covered, in rising order
  std::vector<int> block_of_edge_;        // [E] of the matrix; -1: not covered
  std::vector<bool> edge_is_transposed_;  // [E]
  double num_block_products_ = 0;
  std::vector<Vector6> work_;
};

/// Conjugate gradients with a symmetric block Gauss-Seidel preconditioner, which costs no product
/// with the matrix of its own (Eisenstat 1981).
class BlockGradients {
 public:
  /// Solves A x = b from x = 0 until |r| <= tolerance |b|, both measured through the
  /// preconditioner, or `most` iterations. Returns how many.
  int solve(const BlockMatrix& matrix, const std::vector<Vector6>& b, double tolerance, int most,
            std::vector<Vector6>& x);

  /// A with its diagonal blocks made 1, A = G (1 + L + L^T) G^T: the rows of L one after the other.
  struct Rows {
    std::vector<int> first;               // [N + 1]
    std::vector<int> column;              // [E]
    std::vector<Matrix6> off;             // [E]
    std::vector<Matrix6> inverse_factor;  // [N] of G
  };
  struct Vectors {
    std::vector<Vector6> x, r, p, t, ap;
  };

 private:
  void take(const BlockMatrix& matrix);
  Rows rows_;
  Vectors vectors_;
};

}  // namespace verisim::dem
