// SPDX-License-Identifier: MIT
// Finds the point of a triangle mesh that is nearest to a given point.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "shape/mesh.h"

namespace verisim::shape {

/// The point of the triangle a, b, c nearest to `point`. A triangle without area counts as its
/// three edges, so nothing is divided by zero.
Eigen::Vector3d closest_on_triangle(const Eigen::Vector3d& point, const Eigen::Vector3d& a,
                                    const Eigen::Vector3d& b, const Eigen::Vector3d& c);

struct NearestPoint {
  double squared_distance;  // m^2
  int triangle;             // index into the mesh's triangles
};

/// Binary tree of boxes over the triangles of a mesh. Keeps its own copy of the corners.
class TriangleTree {
 public:
  /// Cost: n log n in triangles. The mesh has at least one.
  explicit TriangleTree(const Mesh& mesh);

  /// Exact to rounding. `guess` is any triangle; one near the answer (that of a neighbouring point)
  /// makes the search short. Cost: about log n.
  NearestPoint nearest(const Eigen::Vector3d& point, int guess = 0) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int first;        // leaf: first of `order_`; else: left child, the right one follows it
    int num_members;  // 0 unless leaf
  };
  struct Corners {
    Eigen::Vector3d a, b, c;
    Eigen::Vector3d middle;  // of a ball that holds them
    double radius;
  };

  void split(int node, int first, int end);

  std::vector<Corners> corners_;  // by triangle
  std::vector<int> order_;        // triangles in the order of the leaves
  std::vector<Node> nodes_;
};

}  // namespace verisim::shape
