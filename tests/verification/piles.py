# SPDX-License-Identifier: MIT
"""Piles, and impacts on what rests: scenes with physics at their defaults."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

Body = dict[str, Any]
EDGE_M = 0.5
CUBE = {"box_m": [EDGE_M] * 3}


def _scene(
    name: str, bodies: list[Body], duration: float, restitution: float, ball_restitution: float = 0
) -> dict[str, Any]:
    """Friction 0.5 everywhere; a contact's restitution is the geometric mean, hence the pairs."""
    wood = {"density_kg_m3": 1000, "restitution": restitution, "friction": 0.5}
    return {
        "schema": 1,
        "name": name,
        "duration_s": duration,
        "materials": {"wood": wood, "rubber": {**wood, "restitution": ball_restitution}},
        "material_pairs": [{"materials": ["rubber", "wood"], "restitution": ball_restitution}],
        "bodies": bodies,
        "ground": {"plane": {"normal": [0, 0, 1], "offset_m": 0}, "material": "wood"},
    }


def _cube(name: str, place: list[float]) -> Body:
    return {"name": name, "shape": CUBE, "material": "wood", "position_m": place}


def stacked_pile(columns: tuple[int, int], layers: int, duration: float) -> dict[str, Any]:
    """Cubes of 125 kg fall from a nearly aligned grid: gaps of 10 mm, 2 mm aside at random."""
    rng = np.random.default_rng(3)
    bodies = []
    for x in range(columns[0]):
        for y in range(columns[1]):
            for z in range(layers):
                aside = rng.uniform(-2e-3, 2e-3, 2)
                place = [
                    (EDGE_M + 0.02) * x + aside[0],
                    (EDGE_M + 0.02) * y + aside[1],
                    (EDGE_M + 0.01) * z + EDGE_M / 2 + 0.01,
                ]
                bodies.append(_cube(f"box-{x}-{y}-{z}", place))
    return _scene(f"stacked-{len(bodies)}", bodies, duration, 0)


def tumbled_pile(num_boxes: int, duration: float) -> dict[str, Any]:
    """Cubes in random orientations fall from a loose grid into a pit."""
    rng = np.random.default_rng(7)
    side = 5 * (num_boxes / 1000) ** (1 / 3)
    row = max(1, int(side / 0.9))
    bodies = []
    for i in range(num_boxes):
        turn = rng.normal(size=4)
        place = [
            (i % row + 0.5) * side / row - side / 2,
            (i // row % row + 0.5) * side / row - side / 2,
            0.5 + 0.9 * (i // row**2),
        ]
        turn /= np.linalg.norm(turn)
        bodies.append({**_cube(f"box-{i}", place), "orientation_wxyz": turn.tolist()})
    for name, x, y in (("east", 1, 0), ("west", -1, 0), ("north", 0, 1), ("south", 0, -1)):
        away = side / 2 + 0.5
        edges = [1 if x else side + 2, 1 if y else side + 2, 60]
        wall = {"name": name, "shape": {"box_m": edges}, "material": "wood", "motion": "fixed"}
        bodies.append({**wall, "position_m": [x * away, y * away, 30]})
    return _scene(f"tumbled-{num_boxes}", bodies, duration, 0)


def ball_into_cubes() -> dict[str, Any]:
    """A ball of 65 kg at 10 m/s hits a block of 3 x 3 x 3 cubes; restitution 0.3."""
    bodies = [
        _cube(f"box-{x}-{y}-{z}", [EDGE_M * (x - 1), EDGE_M * (y - 1), EDGE_M * (z + 0.5)])
        for x in range(3)
        for y in range(3)
        for z in range(3)
    ]
    ball = {"name": "ball", "shape": {"sphere_radius_m": 0.25}, "material": "rubber"}
    bodies.append({**ball, "position_m": [-1.5, 0.1, 0.8], "velocity_m_s": [10, 0, 0]})
    return _scene("ball-into-cubes", bodies, 5, 0.3, 0.3)


def ball_onto_stack() -> dict[str, Any]:
    """A ball of restitution 0.8 falls 1 m onto a stack of five cubes at rest."""
    bodies = [_cube(f"box-{z}", [0, 0, EDGE_M * (z + 0.5)]) for z in range(5)]
    ball = {"name": "ball", "shape": {"sphere_radius_m": 0.1}, "material": "rubber"}
    bodies.append({**ball, "position_m": [0, 0, 5 * EDGE_M + 0.1 + 1]})
    return _scene("ball-onto-stack", bodies, 5, 0, 0.8)


def tipping_box() -> dict[str, Any]:
    """A box of 0.5 x 0.5 x 1 m on its edge, 28 degrees aslant: just beyond its balance."""
    angle = math.radians(28)
    height = 0.25 * math.sin(angle) + 0.5 * math.cos(angle)
    box = {"name": "box", "shape": {"box_m": [0.5, 0.5, 1]}, "material": "wood"}
    turn = [math.cos(angle / 2), 0, math.sin(angle / 2), 0]
    bodies = [{**box, "position_m": [0, 0, height], "orientation_wxyz": turn}]
    return _scene("tipping-box", bodies, 5, 0.3)


IMPACTS = {scene["name"]: scene for scene in (ball_into_cubes(), ball_onto_stack(), tipping_box())}
PENETRATIONS_M = (1e-3, 3e-4, 1e-4, 3e-5, 1e-5)
