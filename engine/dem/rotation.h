// SPDX-License-Identifier: MIT
// How an orientation turns while the angular momentum stays what it is.
#pragma once

#include <Eigen/Geometry>

namespace verisim::dem {

/// The matrix of r x.
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& r);

/// exp of a rotation vector (rad): the quaternion that turns by its length about it.
Eigen::Quaterniond rotation_of(const Eigen::Vector3d& rotation_vector);

/// The source's step: q + dt/2 (0, omega) q, normalised. First order. Angular momentum is the
/// state, so it is conserved, but the energy is not: free spin drifts towards the axis of least
/// energy or most, here upwards (tests/dem/rotation_test.cpp shows it).
Eigen::Quaterniond turn_by_euler(const Eigen::Quaterniond& q_wb,
                                 const Eigen::Vector3d& angular_velocity, double dt);

/// Fourth-order step of q' = omega(q) q / 2, omega = R inverse_inertia_b R^T L with L fixed:
/// Runge-Kutta-Munthe-Kaas, so q stays unit by construction (it is normalised against rounding).
/// Source: Munthe-Kaas 1999, the classical four-stage scheme with two commutators.
Eigen::Quaterniond turn_by_rkmk4(const Eigen::Quaterniond& q_wb,
                                 const Eigen::Matrix3d& inverse_inertia_b,
                                 const Eigen::Vector3d& angular_momentum, double dt);

}  // namespace verisim::dem
