# SPDX-License-Identifier: MIT
"""What a run is judged by: errors against closed forms and fine references, from poses and metrics.

Every function takes a run and its scene as read from the file and returns an error that is 0 if the
run is exact. Lengths in m, speeds in m/s, angles in degrees, the rest relative.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from free_rotation import energies, flip_times, orientation_error_deg
from scipy.optimize import brentq

from verisim.engine import Run

Array = npt.NDArray[np.float64]
Scene = dict[str, Any]
Quantity = Callable[[Run, Scene], float]

GRAVITY = 9.81
# Speeds after a ball hits four others that it touches, all springs linear and equal (Hinch and
# Saint-Jean 1999, Proc. R. Soc. A 455; digits from the chain's own equations).
TOUCHING_CRADLE = (-0.1323, -0.0753, -0.0310, 0.2962, 0.9424)


# Bounces.


def apexes(run: Run, radius: float) -> list[float]:
    """Heights (m) of the ball's lowest point at the top of each flight after a bounce."""
    height, speed = run.poses.position_m[:, 0, 2], run.poses.linear_velocity_m_s[:, 0, 2]
    tops = []
    for before, after in zip(range(speed.size), range(1, speed.size), strict=False):
        flies = height[before] > 1.001 * radius and height[after] > 1.001 * radius
        if flies and speed[before] > 0 >= speed[after]:
            tops.append(float(height[before] - radius + speed[before] ** 2 / (2 * GRAVITY)))
    return tops


def _apex_errors(run: Run, scene: Scene) -> Array:
    radius = scene["bodies"][0]["shape"]["sphere_radius_m"]
    drop = scene["bodies"][0]["position_m"][2] - radius
    restitution = scene["materials"]["rubber"]["restitution"]
    found = apexes(run, radius)[:5]
    if len(found) < 5:
        return np.full(5, np.inf)
    exact = drop * restitution ** (2 * np.arange(1, 6))
    errors: Array = np.abs(np.array(found) / exact - 1)
    return errors


def worst_apex_error(run: Run, scene: Scene) -> float:
    return float(_apex_errors(run, scene).max())


def fifth_apex_error(run: Run, scene: Scene) -> float:
    return float(_apex_errors(run, scene)[4])


# Rest.


def deepest_overlap_m(run: Run, _scene: Scene) -> float:
    return float(run.summary["metrics"]["max_penetration_m"])


def sideways_shift_m(run: Run, _scene: Scene) -> float:
    """Largest horizontal way of any body from where it started, at any time."""
    moved = run.poses.position_m[:, :, :2] - run.poses.position_m[0, :, :2]
    return float(np.linalg.norm(moved, axis=-1).max())


def top_sinks_m(run: Run, _scene: Scene) -> float:
    """How much lower the last body ends."""
    heights = run.poses.position_m[:, -1, 2]
    return float(heights[0] - heights[-1])


# Slopes.


def _slope(scene: Scene) -> tuple[Array, Array, float]:
    """Normal, way down, angle."""
    normal = np.array(scene["ground"]["plane"]["normal"], dtype=float)
    normal /= np.linalg.norm(normal)
    angle = math.acos(normal[2])
    return normal, np.array([math.cos(angle), 0, -math.sin(angle)]), angle


def lift_off_m(run: Run, scene: Scene) -> float:
    """Farthest that the block gets off the plane."""
    normal, _, _ = _slope(scene)
    heights = run.poses.position_m[:, 0] @ normal
    return float(np.abs(heights - heights[0]).max())


def slide_error(run: Run, scene: Scene) -> float:
    _, down, angle = _slope(scene)
    friction = scene["materials"]["wood"]["friction"]
    slid = float((run.poses.position_m[-1, 0] - run.poses.position_m[0, 0]) @ down)
    pull = GRAVITY * (math.sin(angle) - friction * math.cos(angle))
    return abs(slid / (0.5 * pull * float(run.poses.time_s[-1]) ** 2) - 1)


def settling_m(run: Run, _scene: Scene) -> float:
    """Whole way of the block."""
    return float(np.linalg.norm(run.poses.position_m[-1, 0] - run.poses.position_m[0, 0]))


def creep_m_s(run: Run, _scene: Scene) -> float:
    """Mean speed of the block over the second half."""
    half = run.poses.time_s.size // 2
    crept = np.linalg.norm(run.poses.position_m[-1, 0] - run.poses.position_m[half, 0])
    return float(crept / (run.poses.time_s[-1] - run.poses.time_s[half]))


# Free rotation.


def spin_energy_error(run: Run, scene: Scene) -> float:
    found = energies(run, scene["bodies"][0]["shape"]["box_m"])
    return float(np.abs(found / found[0] - 1).max())


def orientation_error_5_s_deg(run: Run, scene: Scene) -> float:
    return orientation_error_deg(run, scene, 5)


def orientation_error_20_s_deg(run: Run, scene: Scene) -> float:
    return orientation_error_deg(run, scene, 20)


def flip_time_error(run: Run, scene: Scene) -> float:
    found, exact = flip_times(run, scene)
    if len(found) != len(exact):
        return math.inf
    return max(abs(a / b - 1) for a, b in zip(found, exact, strict=True))


# Oblique impacts.


def _impact(run: Run, scene: Scene) -> tuple[float, float, float, float, float, float]:
    """Normal, tangential, spin * radius after; the first two before; friction."""
    ball = scene["bodies"][0]
    radius = ball["shape"]["sphere_radius_m"]
    velocity, spin = run.poses.linear_velocity_m_s[-1, 0], run.poses.angular_velocity_rad_s[-1, 0]
    tangential, _, normal = ball["velocity_m_s"]
    return velocity[2], velocity[0], spin[1] * radius, -normal, tangential, _material(scene)[1]


def _material(scene: Scene) -> tuple[float, float]:
    rubber = scene["materials"]["rubber"]
    return rubber["restitution"], rubber["friction"]


def sliding_impact_error(run: Run, scene: Scene) -> float:
    """Worst of normal speed, tangential speed and spin if the ball slides throughout."""
    normal, tangential, surface, vn, vt, friction = _impact(run, scene)
    push = friction * (1 + _material(scene)[0]) * vn
    exact = (_material(scene)[0] * vn, vt - push, 2.5 * push)
    found = (normal, tangential, surface)
    return max(abs(a / b - 1) for a, b in zip(found, exact, strict=True))


def sticking_impact_error(run: Run, scene: Scene) -> float:
    """Worst of the same if the ball sticks, against fine steps of the law that the engine states:
    linear spring with Hunt-Crossley damping, tangential spring 0.8 as stiff, Coulomb's bound."""
    normal, tangential, surface, vn, vt, friction = _impact(run, scene)
    push = _fine_push(vt / vn, _material(scene)[0], friction) * vn
    exact = (_material(scene)[0] * vn, vt - push, 2.5 * push)
    found = (normal, tangential, surface)
    return max(abs(a / b - 1) for a, b in zip(found, exact, strict=True))


def _fine_push(sliding: float, restitution: float, friction: float) -> float:
    """Loss of tangential speed, in units of the approach speed, mass and stiffness."""

    def energy_left(d: float) -> float:  # of f = x (1 + d v): Hunt and Crossley 1975
        return math.log((1 + d) / (1 - d * restitution)) - d * (1 + restitution)

    d = brentq(energy_left, 1e-3, (1 - 1e-12) / restitution)
    h, ratio = math.pi / 50_000, 0.8
    depth, closing, stretch, pushed = 0.0, 1.0, 0.0, 0.0
    while depth >= 0:
        half = closing - 0.5 * h * max(0.0, depth * (1 + d * closing))
        depth += h * half
        load = max(0.0, depth * (1 + d * half))
        closing = half - 0.5 * h * load
        stretch += h * sliding
        bound = friction * load
        force = min(bound, max(-bound, -ratio * (stretch + d * depth * sliding)))
        stretch = min(bound / ratio, max(-bound / ratio, stretch))
        sliding += 3.5 * h * force
        pushed -= h * force
    return pushed


# Cradles and rolling.


def _row_speeds(run: Run) -> Array:
    speeds: Array = run.poses.linear_velocity_m_s[-1, :, 0]
    return speeds


def last_ball_alone_error(run: Run, _scene: Scene) -> float:
    exact = np.zeros(5)
    exact[-1] = 1
    return float(np.abs(_row_speeds(run) - exact).max())


def row_energy_error(run: Run, _scene: Scene) -> float:
    speeds = run.poses.linear_velocity_m_s[-1]
    return abs(float((speeds**2).sum()) - 1)


def row_momentum_error(run: Run, _scene: Scene) -> float:
    return abs(float(_row_speeds(run).sum()) - 1)


def dispersion_error(run: Run, _scene: Scene) -> float:
    return float(np.abs(_row_speeds(run) - np.array(TOUCHING_CRADLE)).max())


def rolling_speed_error(run: Run, scene: Scene) -> float:
    """Against 5/7 of the speed at the start."""
    start = scene["bodies"][0]["velocity_m_s"][0]
    return abs(float(run.poses.linear_velocity_m_s[-1, 0, 0]) / (5 / 7 * start) - 1)


def rolling_slip_error(run: Run, scene: Scene) -> float:
    radius = scene["bodies"][0]["shape"]["sphere_radius_m"]
    spin, speed = run.poses.angular_velocity_rad_s[-1, 0], run.poses.linear_velocity_m_s[-1, 0]
    return abs(float(spin[1] * radius / speed[0]) - 1)


QUANTITIES: dict[str, Quantity] = {
    function.__name__: function
    for function in (
        worst_apex_error,
        fifth_apex_error,
        deepest_overlap_m,
        sideways_shift_m,
        top_sinks_m,
        lift_off_m,
        slide_error,
        settling_m,
        creep_m_s,
        spin_energy_error,
        orientation_error_5_s_deg,
        orientation_error_20_s_deg,
        flip_time_error,
        sliding_impact_error,
        sticking_impact_error,
        last_ball_alone_error,
        row_energy_error,
        row_momentum_error,
        dispersion_error,
        rolling_speed_error,
        rolling_slip_error,
    )
}
