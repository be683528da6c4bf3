# SPDX-License-Identifier: MIT
"""Piles, and impacts on what rests: scenes with physics at their defaults."""

from __future__ import annotations

import math
from typing import Any

from verisim.bench.chart.generated import EDGE_M

Body = dict[str, Any]
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
