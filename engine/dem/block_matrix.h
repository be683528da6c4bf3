// SPDX-License-Identifier: MIT
// A symmetric matrix of 6x6 blocks, one row of blocks per body, and gradients to solve with it.
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
