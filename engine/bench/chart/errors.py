# SPDX-License-Identifier: MIT
"""Errors of single bodies and rows against closed forms, from poses alone."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from verisim.bench.chart import closed_forms
from verisim.bench.chart.trial import Trial

Array = npt.NDArray[np.float64]
NUM_APEXES = 5


# Falling and bouncing.


def fall_error(trial: Trial) -> float:
    """Rms distance (m) from the height of a body that falls flat and stays."""
    height = trial.poses.position_m[:, 0, 2]
    rest = _size(trial) / 2
    exact = rest + closed_forms.fall_height(
        float(height[0]) - rest, trial.gravity, trial.poses.time_s
    )
    return float(np.sqrt(np.mean((height - exact) ** 2)))


def apex_error(trial: Trial) -> float:
    """Largest relative error of the first five tops; 1 where one of them never came."""
    radius = _size(trial) / 2
    drop = float(trial.poses.position_m[0, 0, 2]) - radius
    exact = closed_forms.apex_heights(drop, trial.restitution("rubber"), NUM_APEXES)
    found = _apexes(trial, radius)[:NUM_APEXES]
    if len(found) < NUM_APEXES:
        return 1.0
    return float(np.abs(np.array(found) / exact - 1).max())


def _apexes(trial: Trial, radius: float) -> list[float]:
    """Heights (m) of the ball's lowest point at the top of each flight after a bounce: of the
    ballistic flight through the last sample before each."""
    poses = trial.poses
    height, speed = poses.position_m[:, 0, 2] - radius, poses.linear_velocity_m_s[:, 0, 2]
    rises = speed > 0
    tops = np.flatnonzero(rises[:-1] & ~rises[1:])
    return [
        float(height[i] + speed[i] ** 2 / (2 * trial.gravity))
        for i in tops
        if height[i] > 1e-3 * radius
    ]


def _size(trial: Trial) -> float:
    """Extent (m) of the first body along z."""
    shape = trial.scene["bodies"][0]["shape"]
    if "sphere_radius_m" in shape:
        return 2 * float(shape["sphere_radius_m"])
    return float(shape["box_m"][2])


# Slopes and rolling.


def slide_error(trial: Trial) -> float:
    """Relative error of the way down the slope."""
    down, angle = _slope(trial)
    time = float(trial.poses.time_s[-1])
    exact = closed_forms.slide_distance(angle, trial.friction("wood"), trial.gravity, time)
    return abs(float(_way(trial) @ down) / exact - 1)


def drift_error(trial: Trial) -> float:
    """Way (m) along the slope of what should stick."""
    down, _ = _slope(trial)
    return abs(float(_way(trial) @ down))


def lift_error(trial: Trial) -> float:
    """Farthest (m) that the block gets off the plane or into it."""
    normal = _normal(trial)
    heights = trial.poses.position_m[:, 0] @ normal
    return float(np.abs(heights - heights[0]).max())


def roll_error(trial: Trial) -> float:
    """Relative error of the way rolled at the end."""
    speed = float(trial.scene["bodies"][0]["velocity_m_s"][0])
    time = float(trial.poses.time_s[-1])
    exact = closed_forms.roll_distance(speed, trial.friction("wood"), trial.gravity, time)
    return abs(float(_way(trial)[0]) / exact - 1)


def roll_speed_error(trial: Trial) -> float:
    """Relative error of the speed at the end, 5/7 of the first."""
    speed = float(trial.scene["bodies"][0]["velocity_m_s"][0])
    return abs(float(trial.poses.linear_velocity_m_s[-1, 0, 0]) / (5 / 7 * speed) - 1)


def _way(trial: Trial) -> Array:
    way: Array = trial.poses.position_m[-1, 0] - trial.poses.position_m[0, 0]
    return way


def _normal(trial: Trial) -> Array:
    normal = np.array(trial.scene["ground"]["plane"]["normal"], dtype=float)
    unit: Array = normal / np.linalg.norm(normal)
    return unit


def _slope(trial: Trial) -> tuple[Array, float]:
    """Way down, angle (rad); the slope falls towards x."""
    angle = math.acos(_normal(trial)[2])
    return np.array([math.cos(angle), 0, -math.sin(angle)]), angle


# Impacts.


def oblique_error(trial: Trial) -> float:
    """Worst relative error of normal speed, tangential speed and spin after the impact."""
    ball = trial.scene["bodies"][0]
    tangential, _, normal = ball["velocity_m_s"]
    exact = closed_forms.oblique_impact(
        -normal, tangential, trial.restitution("rubber"), trial.friction("rubber")
    )
    velocity = trial.poses.linear_velocity_m_s[-1, 0]
    surface = trial.poses.angular_velocity_rad_s[-1, 0, 1] * ball["shape"]["sphere_radius_m"]
    found = (velocity[2], velocity[0], surface)
    return max(abs(float(a) / b - 1) for a, b in zip(found, exact, strict=True))


def cradle_error(trial: Trial) -> float:
    """Largest error of any ball's speed, of the first one's: only the last may move."""
    exact = np.zeros((len(trial.poses.names), 3))
    exact[-1] = trial.scene["bodies"][0]["velocity_m_s"]
    error = np.linalg.norm(trial.poses.linear_velocity_m_s[-1] - exact, axis=1).max()
    return float(error / np.linalg.norm(exact[-1]))


def cradle_energy_error(trial: Trial) -> float:
    """Relative error of the kinetic energy of equal balls."""
    start = trial.scene["bodies"][0]["velocity_m_s"]
    end = float(np.sum(trial.poses.linear_velocity_m_s[-1] ** 2))
    return abs(end / float(np.sum(np.square(start))) - 1)


# Free rotation.


def spin_energy_error(trial: Trial) -> float:
    """Largest relative error of the rotational energy."""
    body = trial.scene["bodies"][0]
    turned = _rotations(trial.poses.orientation_wxyz[:, 0])
    spin = turned.apply(trial.poses.angular_velocity_rad_s[:, 0], inverse=True)
    energy = (spin**2) @ closed_forms.box_moments(tuple(body["shape"]["box_m"]))
    start = (np.square(body["angular_velocity_rad_s"])) @ closed_forms.box_moments(
        tuple(body["shape"]["box_m"])
    )
    return float(np.abs(energy / start - 1).max())


def orientation_error(trial: Trial) -> float:
    """Angle (rad) between the orientation at the end and the exact one."""
    body = trial.scene["bodies"][0]
    end = float(trial.poses.time_s[-1])
    solution = closed_forms.free_spin(
        tuple(body["shape"]["box_m"]), tuple(body["angular_velocity_rad_s"]), end
    )
    exact = _rotations(solution(end)[:4])
    between = _rotations(trial.poses.orientation_wxyz[-1, 0]).inv() * exact
    return float(between.magnitude())


def _rotations(quaternions_wxyz: Array) -> Rotation:
    return Rotation.from_quat(quaternions_wxyz[..., [1, 2, 3, 0]])
