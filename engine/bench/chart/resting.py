# SPDX-License-Identifier: MIT
"""Errors of stacks and piles: rigid bodies do not overlap, and what stands stays."""

from __future__ import annotations

import math

import numpy as np

from verisim.bench.chart.overlap import Array, Solids, solids_of
from verisim.bench.chart.trial import Trial

LATE_FRAMES = 6  # over the second half of a run


def deepest_m(trial: Trial) -> float:
    """Deepest overlap (m) at some moments of the second half."""
    return max(float(depths.max(initial=0)) for depths in _late_depths(trial))


def mean_depth_m(trial: Trial) -> float:
    """Mean depth (m) of all overlaps at the same moments."""
    depths = np.concatenate(_late_depths(trial))
    return float(depths.mean()) if depths.size else 0.0


def shift_m(trial: Trial) -> float:
    """Largest way aside (m) of a free body from where it started, at any time."""
    free = trial.free_bodies()
    moved = trial.poses.position_m[:, free, :2] - trial.poses.position_m[0, free, :2]
    return float(np.linalg.norm(moved, axis=-1).max())


def mean_speed_m_s(trial: Trial) -> float:
    """Mean speed (m/s) of the free bodies at the end."""
    speed = np.linalg.norm(trial.poses.linear_velocity_m_s[-1, trial.free_bodies()], axis=-1)
    return float(speed.mean())


def energy_gain_rel(trial: Trial) -> float:
    """Largest rise of the energy of flight and height above its start, of what the bodies could
    fall: bodies of one density and no others. Springs hold more, so this is a lower bound."""
    free = trial.free_bodies()
    mass = _volumes(trial)[free]
    speed = trial.poses.linear_velocity_m_s[:, free]
    height = trial.poses.position_m[:, free, 2]
    energy = (mass * (0.5 * (speed**2).sum(axis=-1) + trial.gravity * height)).sum(axis=-1)
    scale = float((mass * trial.gravity * np.maximum(height[0], 1e-9)).sum())
    return float(max(energy.max() - energy[0], 0)) / scale


def last_falls_s(trial: Trial) -> float:
    """When (s) the last body has tilted by half a radian from upright; infinite if never."""
    last = trial.poses.orientation_wxyz[:, -1]
    upright = 1 - 2 * (last[:, 1] ** 2 + last[:, 2] ** 2)  # z component of the body's z axis
    tilt = np.arccos(np.clip(upright, -1, 1))
    after = np.flatnonzero(tilt > 0.5)
    if after.size == 0:
        return math.inf
    end = int(after[0])
    if end == 0:
        return 0.0
    share = (0.5 - tilt[end - 1]) / (tilt[end] - tilt[end - 1])
    return float(trial.poses.time_s[end - 1] + share * np.diff(trial.poses.time_s)[end - 1])


def mean_height_m(trial: Trial) -> float:
    """Mean height (m) of the free bodies at the end: how loosely a heap lies."""
    return float(trial.poses.position_m[-1, trial.free_bodies(), 2].mean())


def _late_depths(trial: Trial) -> list[Array]:
    solids = _solids(trial)
    count = trial.poses.time_s.size
    frames = np.unique(np.linspace(count // 2, count - 1, LATE_FRAMES).astype(int))
    return [
        solids.depths(trial.poses.position_m[i], trial.poses.orientation_wxyz[i]) for i in frames
    ]


def _solids(trial: Trial) -> Solids:
    return solids_of(trial.scene, trial.folder)


def _volumes(trial: Trial) -> Array:
    """Of each body (m3); meshes count as 1, since a scene's are all alike."""
    volumes = []
    for body in trial.scene["bodies"]:
        shape = body["shape"]
        if "box_m" in shape:
            volumes.append(float(np.prod(shape["box_m"])))
        elif "sphere_radius_m" in shape:
            volumes.append(4 / 3 * math.pi * float(shape["sphere_radius_m"]) ** 3)
        else:
            volumes.append(1.0)
    return np.array(volumes)
