// SPDX-License-Identifier: MIT
// What contacts need of a body given by a mesh: where its surface is, and points on it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "dem/distance_field.h"

namespace verisim::dem {

/// A point of the surface that is tested against the distance field of the other body.
struct SurfacePoint {
  Eigen::Vector3d position_b;  // m
  // Dimensionless share of the surface it stands for, independent of the sample spacing in sum:
  // 1 for a sharp convex corner, length / reference_length for a piece of a sharp convex edge,
  // area / reference_length^2 for a piece of a face.
  double weight;
};

/// A run of neighbouring points and a ball that holds them, to pass over them all at once. Blocks
/// of more than 32 points are halved into the blocks that follow them.
struct SurfaceBlock {
  int first;
  int count;
  Eigen::Vector3d centre_b;  // m
  double radius;             // m
  int next;                  // block after this one and its parts
};

struct MeshSurface {
  DistanceField field;
  std::vector<SurfacePoint> points;  // sorted into blocks
  std::vector<SurfaceBlock> blocks;  // a block before its parts; the smallest cover all in order
  double reference_length = 0;       // m, of the weights: a quarter of the smallest extent
  double reach = 0;                  // m, from the centre of mass to the farthest vertex
};

}  // namespace verisim::dem
