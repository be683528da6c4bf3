# SPDX-License-Identifier: MIT
"""Free rotation of a box, against an eighth-order integration of Euler's equations."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from verisim.bench.chart.closed_forms import box_moments, free_spin
from verisim.engine import Run

Array = npt.NDArray[np.float64]


def _rotations(quaternions_wxyz: Array) -> Rotation:
    return Rotation.from_quat(quaternions_wxyz[..., [1, 2, 3, 0]])


def spin_b(run: Run) -> Array:
    """Angular velocity of the first body in its own frame."""
    turned = _rotations(run.poses.orientation_wxyz[:, 0])
    spin: Array = turned.apply(run.poses.angular_velocity_rad_s[:, 0], inverse=True)
    return spin


def energies(run: Run, edges: list[float]) -> Array:
    """Per mass."""
    values: Array = 0.5 * (spin_b(run) ** 2) @ box_moments(tuple(edges))
    return values


def _exact_of(run: Run, scene: dict[str, Any]) -> Any:
    body = scene["bodies"][0]
    edges, spin = tuple(body["shape"]["box_m"]), tuple(body["angular_velocity_rad_s"])
    return free_spin(edges, spin, float(run.poses.time_s[-1]))


def orientation_error_deg(run: Run, scene: dict[str, Any], time: float) -> float:
    index = int(np.argmin(np.abs(run.poses.time_s - time)))
    exact = _exact_of(run, scene)(run.poses.time_s[index])[:4]
    between = _rotations(run.poses.orientation_wxyz[index, 0]).inv() * _rotations(exact)
    return float(np.degrees(between.magnitude()))


def flip_times(run: Run, scene: dict[str, Any]) -> tuple[list[float], list[float]]:
    """Times at which the middle component of the spin changes its sign: in the run, exactly."""
    times = run.poses.time_s
    found = CubicSpline(times, spin_b(run)[:, 1]).roots(extrapolate=False)
    fine = np.linspace(0, times[-1], 40 * times.size)
    exact = CubicSpline(fine, _exact_of(run, scene)(fine)[5]).roots(extrapolate=False)
    return list(found), list(exact)
