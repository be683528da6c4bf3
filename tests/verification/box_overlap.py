# SPDX-License-Identifier: MIT
"""How deep boxes lie in each other, by poses alone: the separating-axis test over 15 axes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

Array = npt.NDArray[np.float64]


def overlaps(position: Array, orientation_wxyz: Array, half: Array) -> Array:
    """Depths (m) of all pairs of equal boxes that overlap, and of boxes in the floor z = 0."""
    axes = Rotation.from_quat(orientation_wxyz[:, [1, 2, 3, 0]]).as_matrix()
    pairs = cKDTree(position).query_pairs(2 * float(np.linalg.norm(half)), output_type="ndarray")
    a, b = axes[pairs[:, 0]], axes[pairs[:, 1]]  # columns: the boxes' own axes
    apart = position[pairs[:, 1]] - position[pairs[:, 0]]
    crossed = np.cross(a[:, :, :, None], b[:, :, None, :], axis=1).reshape(-1, 3, 9)
    length = np.linalg.norm(crossed, axis=1, keepdims=True)
    is_parallel = length[:, 0] < 1e-6
    crossed = crossed / np.where(length < 1e-6, 1, length)
    directions = np.concatenate([a, b, crossed], axis=2)  # [P, 3, 15]
    reach = _reach(a, directions, half) + _reach(b, directions, half)
    depth = reach - np.abs(np.einsum("pi,pik->pk", apart, directions))
    depth[:, 6:][is_parallel] = np.inf
    between = depth.min(axis=1)
    in_floor = (np.abs(axes[:, 2, :]) @ half) - position[:, 2]
    found: Array = np.concatenate([between[between > 0], in_floor[in_floor > 0]])
    return found


def _reach(axes: Array, directions: Array, half: Array) -> Array:
    along = np.abs(np.einsum("pij,pik->pkj", axes, directions))
    reach: Array = along @ half
    return reach
