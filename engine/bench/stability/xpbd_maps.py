# SPDX-License-Identifier: MIT
"""Maps of method xpbd: what the number of substeps decides."""

from __future__ import annotations

import math
from functools import cache

from verisim.bench.stability import limits
from verisim.bench.stability.cells import (
    HOLDS,
    METHODS,
    Grid,
    Judge,
    Line,
    Pose,
    Prediction,
    Scene,
    StabilityMap,
    logs,
    make_scene,
    whole_logs,
)
from verisim.bench.stability.xpbd_column import Settling, settle

METHOD = "xpbd"
FRAME = 1 / 60  # s
EDGE = 0.2  # m
MASS = 1.0  # kg
LEAN = 1e-4 * EDGE  # of each box against the one below: a seed for what grows
COLUMN_S = 2.0
DEEP = 0.05  # of a body: the engine's failure `penetration`
BALL = 0.1  # m, diameter
DENSITY = 1000.0
WALL_SPEED = 10.0  # m/s
RESTITUTION = 0.5
WEIGHTLESS = [0, 0, 0]


def _physics(substeps: float) -> Scene:
    return {**METHODS[METHOD], "substeps": int(substeps)}


# Columns: one sweep per substep leaves an overlap, the more the heavier what stands on a body is.


@cache
def _settling(masses: tuple[float, ...], substeps: int) -> Settling:
    return settle(masses, FRAME / substeps, COLUMN_S, FRAME)


def _pose_column(masses: tuple[float, ...], substeps: float) -> Pose:
    bodies = [
        {
            "name": f"box{number}",
            "shape": {"box_m": [EDGE] * 3},
            "density": mass / EDGE**3,
            "position_m": [LEAN * number, 0.0, EDGE * (number + 0.5)],
        }
        for number, mass in enumerate(masses)
    ]
    scene = make_scene(
        "column",
        COLUMN_S,
        _physics(substeps),
        bodies,
        expect={"stands": [body["name"] for body in bodies]},
        restitution=RESTITUTION,
    )
    return Pose(scene, Judge("column", EDGE), FRAME)


def _predict_column(masses: tuple[float, ...], substeps: float) -> Prediction:
    found = _settling(masses, int(substeps))
    share = found.deepest_m / (DEEP * EDGE)
    if share > 1:
        # Deeper than 5 %: the boxes' faces, clipped that deep, no longer hold them upright.
        return Prediction(("S", "X"), "one sweep", share)
    if found.rings:
        return Prediction(("J",), "ringing", share)
    return Prediction((HOLDS,), "none", share)


def _depth_line(loads: tuple[float, ...], label: str) -> Line:
    """Substeps at which the first swing, 3.4 times carried g h^2 / 2, is 5 % of an edge deep."""
    substeps = [
        FRAME / math.sqrt(2 * DEEP * EDGE / (3.4 * load * limits.GRAVITY)) for load in loads
    ]
    return Line(label, loads, tuple(substeps))


def _tower() -> StabilityMap:
    def masses(height: float) -> tuple[float, ...]:
        return (MASS,) * int(height)

    heights = whole_logs(2, 40, 12)
    substeps = (1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 64.0)
    return StabilityMap(
        "tower",
        METHOD,
        "Tower: height and substeps",
        "boxes",
        "substeps in 1/60 s",
        Grid(heights, substeps),
        Grid((2, 5, 10), (1.0, 4.0, 16.0)),
        lambda height, number: _pose_column(masses(height), number),
        lambda height, number: _predict_column(masses(height), number),
        lambda: [_depth_line(heights, "3.4 N g h²/2 = 5 %")],
    )


def _ratio() -> StabilityMap:
    def masses(ratio: float) -> tuple[float, ...]:
        return (MASS, ratio * MASS)

    ratios = logs(1, 1e4, 13)
    substeps = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0)
    return StabilityMap(
        "mass_ratio",
        METHOD,
        "A heavy box on a light one",
        "mass above / mass below",
        "substeps in 1/60 s",
        Grid(ratios, substeps),
        Grid(logs(1, 1e4, 5), (2.0, 16.0)),
        lambda ratio, number: _pose_column(masses(ratio), number),
        lambda ratio, number: _predict_column(masses(ratio), number),
        lambda: [_depth_line(ratios, "3.4 R g h²/2 = 5 %")],
    )


# A fast ball at a wall: flights end on touch-down, however thin the wall is.


def _wall() -> StabilityMap:
    def pose(way: float, thickness: float) -> Pose:
        frame = 4 * way * BALL / WALL_SPEED  # of four substeps
        wall = {
            "name": "wall",
            "shape": {"box_m": [3 * BALL, 3 * BALL, thickness * BALL]},
            "density": DENSITY,
            "position_m": [0, 0, -thickness * BALL / 2],
            "motion": "fixed",
        }
        ball = {
            "name": "ball",
            "shape": {"sphere_radius_m": BALL / 2},
            "density": DENSITY,
            "position_m": [0, 0, 1.23 * BALL],
            "velocity_m_s": [0, 0, -WALL_SPEED],
        }
        duration = frame * math.ceil(3 * BALL / WALL_SPEED / frame)
        scene = make_scene(
            "wall",
            duration,
            {**_physics(4), "dt_s": frame},
            [wall, ball],
            gravity_m_s2=WEIGHTLESS,
            ground=False,
            restitution=1.0,
            friction=0.0,
        )
        return Pose(scene, Judge("wall", BALL), duration / 100)

    return StabilityMap(
        "tunnelling",
        METHOD,
        "A fast ball at a thin wall",
        "way in a substep against the ball, v h / D",
        "wall against the ball, thickness / D",
        Grid(logs(0.05, 4, 16), logs(0.01, 1, 9)),
        Grid(logs(0.1, 4, 4), (0.01, 0.1, 1.0)),
        pose,
        lambda _way, _thickness: Prediction((HOLDS,), "none", 0),
        list,
    )


# Restitution: what approaches slower than 2 g h does not rebound.


def _bounce() -> StabilityMap:
    def threshold(substeps: float) -> float:
        return 2 * limits.GRAVITY * FRAME / substeps

    def pose(substeps: float, speed: float) -> Pose:
        ball = {
            "name": "ball",
            "shape": {"sphere_radius_m": BALL / 2},
            "density": DENSITY,
            "position_m": [0, 0, BALL / 2],
            "velocity_m_s": [0, 0, -speed],
        }
        # Sideways gravity of the threshold's size leaves the bounce alone.
        scene = make_scene(
            "bounce",
            2 * FRAME,
            _physics(substeps),
            [ball],
            gravity_m_s2=[limits.GRAVITY, 0, 0],
            restitution=RESTITUTION,
            friction=0.0,
        )
        return Pose(scene, Judge("bounce", BALL, RESTITUTION), FRAME)

    def predict(substeps: float, speed: float) -> Prediction:
        share = threshold(substeps) / speed
        return Prediction(("E",) if share >= 1 else (HOLDS,), "threshold", share)

    substeps = whole_logs(1, 128, 15)
    return StabilityMap(
        "restitution",
        METHOD,
        "A ball that bounces: approach speed and substeps",
        "substeps in 1/60 s",
        "approach, m/s",
        Grid(substeps, logs(1e-3, 1, 16)),
        Grid((1.0, 8.0, 64.0), logs(2e-3, 0.8, 6)),
        pose,
        predict,
        lambda: [Line("2 g h", substeps, tuple(threshold(n) for n in substeps))],
    )


def xpbd_maps() -> list[StabilityMap]:
    return [_tower(), _ratio(), _wall(), _bounce()]
