# SPDX-License-Identifier: MIT
"""Small scenes for the tests of other engines."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

# A box of 0.2 x 0.4 x 0.6 m, turned 30 degrees about z in its own file and moved off its centre.
EDGES = np.array([0.2, 0.4, 0.6])
TURN_DEG = 30.0
_QUADS = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


def write_scene(folder: Path, bodies: list[dict[str, Any]], **keys: Any) -> Path:
    """A scene file (YAML holds JSON) of one material on a level floor unless keys say otherwise."""
    scene = {
        "schema": 1,
        "name": "small",
        "duration_s": 0.5,
        "materials": {"wood": {"density_kg_m3": 500, "restitution": 0, "friction": 0.5}},
        "bodies": bodies,
        "ground": {"plane": {}, "material": "wood"},
        **keys,
    }
    scene = {key: value for key, value in scene.items() if value is not None}
    file = folder / "small.yaml"
    file.write_text(json.dumps(scene), "utf-8")
    return file


def ball(**keys: Any) -> dict[str, Any]:
    return {"name": "ball", "shape": {"sphere_radius_m": 0.1}, "material": "wood", **keys}


def box(**keys: Any) -> dict[str, Any]:
    shape = {"box_m": [0.2, 0.2, 0.2]}
    return {"name": "box", "shape": shape, "material": "wood", **keys}


def write_turned_box(folder: Path) -> Path:
    """An OBJ file of the turned box: its axes of inertia are not its file's axes."""
    angle = np.radians(TURN_DEG)
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    signs = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    corners = np.array(signs) * EDGES / 2 @ turn.T + [0.05, -0.02, 0.3]
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in corners.tolist()]
    for a, b, c, d in _QUADS:
        lines += [f"f {a + 1} {b + 1} {c + 1}", f"f {a + 1} {c + 1} {d + 1}"]
    file = folder / "turned_box.obj"
    file.write_text("\n".join([*lines, ""]), "utf-8")
    return file
