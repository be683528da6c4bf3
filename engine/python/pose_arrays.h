// SPDX-License-Identifier: MIT
// Poses as NumPy arrays: times [T], positions [T, B, 3] and orientations wxyz [T, B, 4].
#pragma once

#include <nanobind/ndarray.h>

#include "dem/pose_log.h"
#include "scene/scene.h"

namespace verisim::python {

using TimeArray =
    nanobind::ndarray<const double, nanobind::ndim<1>, nanobind::c_contig, nanobind::device::cpu>;
using PoseArray =
    nanobind::ndarray<const double, nanobind::ndim<3>, nanobind::c_contig, nanobind::device::cpu>;

/// The log of the scene's bodies, in file order; velocities are left at zero.
/// The caller has checked that shapes and bodies agree.
inline dem::PoseLog pose_log_of(const scene::Scene& scene, const TimeArray& times,
                                const PoseArray& positions, const PoseArray& orientations) {
  dem::PoseLog log;
  for (const scene::Body& body : scene.bodies) log.names.push_back(body.name);
  log.times.assign(times.data(), times.data() + times.shape(0));
  for (std::size_t t = 0; t < times.shape(0); ++t) {
    for (std::size_t b = 0; b < log.num_bodies(); ++b) {
      dem::Pose pose;
      pose.position = {positions(t, b, 0), positions(t, b, 1), positions(t, b, 2)};
      pose.orientation = Eigen::Quaterniond(orientations(t, b, 0), orientations(t, b, 1),
                                            orientations(t, b, 2), orientations(t, b, 3))
                             .normalized();
      log.poses.push_back(pose);
    }
  }
  return log;
}

}  // namespace verisim::python
