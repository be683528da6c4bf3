// SPDX-License-Identifier: MIT
// The pose log: where every body was at each sampled time. The only physics the renderer sees.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace verisim::dem {

/// Position and orientation of one body at one time. World frame, centre of mass.
struct Pose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();               // m
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  // q_wb, body to world
  Eigen::Vector3d linear_velocity = Eigen::Vector3d::Zero();        // m/s
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();       // rad/s
};

/// Poses of all bodies over time, row-major [time][body].
struct PoseLog {
  std::vector<std::string> names;  // [B] file order
  std::vector<double> times;       // [T] s
  std::vector<Pose> poses;         // [T * B]

  std::size_t num_bodies() const { return names.size(); }
  std::size_t num_times() const { return times.size(); }
  const Pose& at(std::size_t time, std::size_t body) const {
    return poses[time * names.size() + body];
  }
};

}  // namespace verisim::dem
