# SPDX-License-Identifier: MIT
"""The distance to the reference's run is the rms over times and free bodies."""

from __future__ import annotations

import numpy as np
import pytest

from verisim.pose_log import PoseLog
from verisim.stimuli.trajectory_error import free_bodies, trajectory_error


def pose_log(position_m: list[list[list[float]]], names: list[str], dt_s: float = 0.1) -> PoseLog:
    position = np.array(position_m, dtype=float)
    times, bodies, _ = position.shape
    return PoseLog(
        names=names,
        time_s=np.arange(times, dtype=np.float64) * dt_s,
        position_m=position,
        orientation_wxyz=np.tile([1.0, 0, 0, 0], (times, bodies, 1)),
        linear_velocity_m_s=np.zeros_like(position),
        angular_velocity_rad_s=np.zeros_like(position),
    )


STILL = pose_log([[[0, 0, 0], [5, 0, 0]]] * 2, ["a", "b"])


def test_it_is_the_rms_over_times_and_free_bodies() -> None:
    run = pose_log([[[3, 4, 0], [9, 0, 0]], [[0, 0, 0], [5, 0, 0]]], ["a", "b"])
    assert trajectory_error(run, STILL, ["a"]) == pytest.approx(np.sqrt(25 / 2), rel=1e-12)
    assert trajectory_error(run, STILL, ["a", "b"]) == pytest.approx(
        np.sqrt((25 + 16) / 4), rel=1e-12
    )
    assert trajectory_error(STILL, STILL, ["a", "b"]) == 0


def test_a_run_that_ended_early_is_compared_as_far_as_it_goes() -> None:
    run = pose_log([[[1, 0, 0], [5, 0, 0]]], ["a", "b"])
    assert trajectory_error(run, STILL, ["a"]) == pytest.approx(1, rel=1e-12)


def test_bodies_are_matched_by_name_and_nothing_in_common_gives_none() -> None:
    swapped = pose_log([[[5, 0, 0], [0, 0, 2]]] * 2, ["b", "a"])
    assert trajectory_error(swapped, STILL, ["a", "b"]) == pytest.approx(np.sqrt(2), rel=1e-12)
    assert trajectory_error(STILL, STILL, ["c"]) is None
    assert trajectory_error(pose_log([[[0, 0, 0]]] * 2, ["a"], 0.2), STILL, ["a"]) is None


def test_free_bodies_are_those_that_forces_move() -> None:
    scene = """
bodies:
  - {name: a}
  - {name: b, motion: fixed}
  - {name: c, motion: {poses: c.npz}}
  - {name: d, motion: free}
"""
    assert free_bodies(scene) == ["a", "d"]
