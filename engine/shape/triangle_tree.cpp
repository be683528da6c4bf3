// SPDX-License-Identifier: MIT
// Builds the tree by halving at the median, and searches it nearest box first.
#include "shape/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace verisim::shape {
namespace {

constexpr int kMaxLeafMembers = 4;
constexpr int kMaxDepth = 64;  // halving 2^31 triangles takes 31 levels

Eigen::Vector3d closest_on_segment(const Eigen::Vector3d& point, const Eigen::Vector3d& a,
                                   const Eigen::Vector3d& b) {
  const Eigen::Vector3d edge = b - a;
  const double along = edge.dot(point - a);
  const double squared_length = edge.squaredNorm();
  if (!(along > 0)) return a;
  if (along >= squared_length) return b;
  return a + along / squared_length * edge;
}

}  // namespace

Eigen::Vector3d closest_on_triangle(const Eigen::Vector3d& point, const Eigen::Vector3d& a,
                                    const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double squared_normal = normal.squaredNorm();
  const bool has_area = squared_normal > 0;
  // Beside an edge: on its outer side. The closest point then lies on such an edge.
  const bool beside_ab = !has_area || normal.dot((b - a).cross(point - a)) < 0;
  const bool beside_bc = !has_area || normal.dot((c - b).cross(point - b)) < 0;
  const bool beside_ca = !has_area || normal.dot((a - c).cross(point - c)) < 0;
  Eigen::Vector3d best = point;
  double least = std::numeric_limits<double>::infinity();
  const auto try_edge = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Eigen::Vector3d closest = closest_on_segment(point, from, to);
    const double squared = (closest - point).squaredNorm();
    if (squared >= least) return;
    best = closest;
    least = squared;
  };
  if (beside_ab) try_edge(a, b);
  if (beside_bc) try_edge(b, c);
  if (beside_ca) try_edge(c, a);
  if (beside_ab || beside_bc || beside_ca) return best;
  return point - normal.dot(point - a) / squared_normal * normal;
}

TriangleTree::TriangleTree(const Mesh& mesh) {
  corners_.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    Corners corners{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], {}, 0};
    corners.middle = (corners.a + corners.b + corners.c) / 3;
    for (const Eigen::Vector3d& corner : {corners.a, corners.b, corners.c}) {
      corners.radius = std::max(corners.radius, (corner - corners.middle).norm());
    }
    corners_.push_back(corners);
  }
  order_.resize(corners_.size());
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.emplace_back();
  split(0, 0, static_cast<int>(order_.size()));
}

void TriangleTree::split(int node, int first, int end) {
  Eigen::AlignedBox3d box, middles;
  for (int m = first; m < end; ++m) {
    const Corners& triangle = corners_[order_[m]];
    box.extend(triangle.a).extend(triangle.b).extend(triangle.c);
    middles.extend(triangle.middle);
  }
  nodes_[node] = {box, first, end - first};
  if (end - first <= kMaxLeafMembers) return;
  int axis = 0;
  middles.sizes().maxCoeff(&axis);
  const int middle = first + (end - first) / 2;
  std::nth_element(
      order_.begin() + first, order_.begin() + middle, order_.begin() + end, [&](int s, int t) {
        return std::pair(corners_[s].middle[axis], s) < std::pair(corners_[t].middle[axis], t);
      });
  const int left = static_cast<int>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node].first = left;
  nodes_[node].num_members = 0;
  split(left, first, middle);
  split(left + 1, middle, end);
}

NearestPoint TriangleTree::nearest(const Eigen::Vector3d& point, int guess) const {
  const auto squared_distance_to = [&](const Corners& t) {
    return (closest_on_triangle(point, t.a, t.b, t.c) - point).squaredNorm();
  };
  NearestPoint best{squared_distance_to(corners_[guess]), guess};
  double distance = std::sqrt(best.squared_distance);
  struct Waiting {
    int node;
    double squared_distance;
  };
  std::array<Waiting, kMaxDepth> stack;
  int num_waiting = 0;
  stack[num_waiting++] = {0, nodes_[0].box.squaredExteriorDistance(point)};
  while (num_waiting > 0) {
    const Waiting next = stack[--num_waiting];
    if (next.squared_distance >= best.squared_distance) continue;
    const Node& node = nodes_[next.node];
    for (int m = node.first; m < node.first + node.num_members; ++m) {
      const Corners& triangle = corners_[order_[m]];
      // The ball around it is tested first: most triangles of a leaf are too far.
      const double limit = distance + triangle.radius;
      if ((triangle.middle - point).squaredNorm() > limit * limit) continue;
      const double squared = squared_distance_to(triangle);
      if (squared >= best.squared_distance) continue;
      best = {squared, order_[m]};
      distance = std::sqrt(squared);
    }
    if (node.num_members > 0) continue;
    Waiting near{node.first, nodes_[node.first].box.squaredExteriorDistance(point)};
    Waiting far{node.first + 1, nodes_[node.first + 1].box.squaredExteriorDistance(point)};
    if (far.squared_distance < near.squared_distance) std::swap(near, far);
    stack[num_waiting++] = far;
    stack[num_waiting++] = near;
  }
  return best;
}

}  // namespace verisim::shape
