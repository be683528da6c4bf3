// SPDX-License-Identifier: MIT
// The error that refuses a mesh, and how a place in space is written in messages.
#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <string>

namespace verisim::shape {

/// Refusal of a mesh file; the message names the file, what was seen, and ends with a `hint:`.
class MeshError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// "(x, y, z)" with six significant digits.
std::string point_text(const Eigen::Vector3d& point);

}  // namespace verisim::shape
