// SPDX-License-Identifier: MIT
// The surface of a body as method `dem` sees it.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <variant>

#include "dem/mesh_surface.h"

namespace verisim::dem {

struct SphereShape {
  double radius = 0;  // m
};

struct BoxShape {
  Eigen::Vector3d half = Eigen::Vector3d::Zero();  // m, half edges along the body's axes
  // Surface points for contact with meshes; empty where a scene has none.
  std::shared_ptr<const MeshSurface> surface;
};

struct MeshShape {
  std::shared_ptr<const MeshSurface> surface;
};

/// Solid below z = 0 of its own frame; never moves.
struct PlaneShape {};

using CollisionShape = std::variant<PlaneShape, SphereShape, BoxShape, MeshShape>;

}  // namespace verisim::dem
