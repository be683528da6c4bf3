// SPDX-License-Identifier: MIT
// Writes a place in space for messages.
#include "shape/mesh_error.h"

#include <sstream>

namespace verisim::shape {

std::string point_text(const Eigen::Vector3d& point) {
  std::ostringstream text;
  text << '(' << point.x() << ", " << point.y() << ", " << point.z() << ')';
  return text.str();
}

}  // namespace verisim::shape
