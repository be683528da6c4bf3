# SPDX-License-Identifier: MIT
"""Errors of boxes that nothing outside acts on: momentum, angular momentum and energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from verisim.bench.chart.overlap import Array
from verisim.bench.chart.trial import Trial


def momentum_error_rel(trial: Trial) -> float:
    """Change of the total momentum by the end, of the sum of what the bodies have at first."""
    return _change(_books(trial).momentum)


def angular_momentum_error_rel(trial: Trial) -> float:
    """Change of the total angular momentum about the origin by the end, of the sum of the bodies'
    at first. (Between, a step longer than a frame leaves poses that lie between its ends.)"""
    return _change(_books(trial).angular_momentum)


def kinetic_gain_rel(trial: Trial) -> float:
    """Largest rise of the kinetic energy above its start, of that. What lies in springs is not in
    it, so that it can rise between frames of an impact, never above the start."""
    energy = _books(trial).energy.sum(axis=1)
    return float(max(energy.max() / energy[0] - 1, 0))


def kinetic_left_rel(trial: Trial) -> float:
    """Kinetic energy at the end, of that at first: what impacts and friction have left."""
    energy = _books(trial).energy.sum(axis=1)
    return float(energy[-1] / energy[0])


@dataclass(frozen=True)
class _Books:
    """Of each frame and body."""

    momentum: Array  # [F, B, 3], kg m/s
    angular_momentum: Array  # [F, B, 3], kg m2/s, about the origin
    energy: Array  # [F, B], J


def _books(trial: Trial) -> _Books:
    edges = np.array([body["shape"]["box_m"] for body in trial.scene["bodies"]], dtype=float)
    density = [
        trial.scene["materials"][body["material"]]["density_kg_m3"]
        for body in trial.scene["bodies"]
    ]
    mass = edges.prod(axis=1) * density
    squares = edges**2
    moments = mass[:, None] * (squares.sum(axis=1, keepdims=True) - squares) / 12
    poses = trial.poses
    frames, bodies = poses.position_m.shape[:2]
    turns = Rotation.from_quat(poses.orientation_wxyz.reshape(-1, 4)[:, [1, 2, 3, 0]])
    spin = poses.angular_velocity_rad_s.reshape(-1, 3)
    own = np.tile(moments, (frames, 1)) * turns.apply(spin, inverse=True)
    own = turns.apply(own).reshape(frames, bodies, 3)
    momentum = mass[:, None] * poses.linear_velocity_m_s
    energy = 0.5 * (momentum * poses.linear_velocity_m_s + own * poses.angular_velocity_rad_s)
    return _Books(momentum, np.cross(poses.position_m, momentum) + own, energy.sum(axis=2))


def _change(amounts: Array) -> float:
    """Of the total over bodies, relative to the sum of magnitudes at first."""
    total = amounts.sum(axis=1)
    change = np.linalg.norm(total[-1] - total[0])
    return float(change / np.linalg.norm(amounts[0], axis=1).sum())
