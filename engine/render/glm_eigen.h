// SPDX-License-Identifier: MIT
// The one border between Eigen (double, the engine) and glm (float, the graphics card).
// Quaternions: Eigen's constructor and glm's both take w, x, y, z; memory order is never relied on.
#pragma once

#include <Eigen/Geometry>
#include <glm/glm.hpp>

#include "dem/pose_log.h"

namespace verisim::render {

inline glm::vec3 to_glm(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// Body axes about the centre of mass to world.
inline glm::mat4 body_to_world(const dem::Pose& pose) {
  const Eigen::Matrix3d rotation = pose.orientation.toRotationMatrix();
  return {glm::vec4(to_glm(rotation.col(0)), 0), glm::vec4(to_glm(rotation.col(1)), 0),
          glm::vec4(to_glm(rotation.col(2)), 0), glm::vec4(to_glm(pose.position), 1)};
}

}  // namespace verisim::render
