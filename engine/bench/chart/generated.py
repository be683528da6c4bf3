# SPDX-License-Identifier: MIT
"""Bench scenes of many bodies, made from a few numbers and seeds instead of long files."""

from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

from verisim.bench.chart.trial import Scene

Body = dict[str, Any]
EDGE_M = 0.5  # of the cubes of piles; 125 kg
STONE = "stone.obj"
SCENES = Path(__file__).parent.parent / "scenes"


def _scene(
    name: str, bodies: list[Body], duration_s: float, material: dict[str, float], **more: Any
) -> Scene:
    return {
        "schema": 1,
        "name": name,
        "duration_s": duration_s,
        "materials": {"wood": material},
        "bodies": bodies,
        "ground": {"plane": {"normal": [0, 0, 1], "offset_m": 0}, "material": "wood"},
        **more,
    }


def _box(name: str, edges: list[float], place: list[float], **more: Any) -> Body:
    return {
        "name": name,
        "shape": {"box_m": edges},
        "material": "wood",
        "position_m": [float(x) for x in place],
        **more,
    }


def tower(count: int) -> Scene:
    """Boxes of 1 m and 1 kg on each other, for 10 s."""
    bodies = [_box(f"box{n}", [1, 1, 1], [0, 0, n + 0.5]) for n in range(count)]
    wood = {"density_kg_m3": 1, "restitution": 0, "friction": 0.5}
    names = [body["name"] for body in bodies]
    return _scene(f"tower_{count}", bodies, 10, wood, expect={"stands": names})


def mass_ratio(ratio: int) -> Scene:
    """A box of `ratio` kg on one of 1 kg, cubes of 1 m, for 10 s."""
    light = {"density_kg_m3": 1, "restitution": 0, "friction": 0.5}
    bodies = [_box("light", [1, 1, 1], [0, 0, 0.5]), _box("heavy", [1, 1, 1], [0, 0, 1.5])]
    bodies[1]["material"] = "metal"
    scene = _scene(f"mass_ratio_{ratio}", bodies, 10, light, expect={"stands": ["light", "heavy"]})
    scene["materials"]["metal"] = {**light, "density_kg_m3": ratio}
    return scene


def dominoes(count: int = 20) -> Scene:
    """Dominoes of 20 x 100 x 200 mm, 100 mm apart; the first comes tilted by 0.15 rad."""
    wood = {"density_kg_m3": 600, "restitution": 0, "friction": 0.4}
    bodies = [_box(f"domino{n}", [0.02, 0.1, 0.2], [0.1 * n, 0, 0.1]) for n in range(count)]
    tilt = 0.15
    bodies[0]["orientation_wxyz"] = [math.cos(tilt / 2), 0, math.sin(tilt / 2), 0]
    bodies[0]["position_m"] = [0.0, 0, 0.1 * math.cos(tilt) + 0.01 * math.sin(tilt)]
    return _scene("dominoes", bodies, 3, wood)


def dice(count: int) -> Scene:
    """Cubes of 0.1 m thrown far from each other: as many seeds of one chaotic throw, in one run."""
    rng = np.random.default_rng(17)
    row = math.ceil(math.sqrt(count))
    bodies = []
    for i in range(count):
        angle = rng.uniform(0, 2 * math.pi)
        speed = rng.uniform(1, 2)
        bodies.append(
            _box(
                f"die-{i}",
                [0.1] * 3,
                [6.0 * (i % row), 6.0 * (i // row), rng.uniform(0.4, 0.8)],
                orientation_wxyz=_turn(rng),
                velocity_m_s=[speed * math.cos(angle), speed * math.sin(angle), 0.0],
                angular_velocity_rad_s=[float(x) for x in rng.uniform(-10, 10, 3)],
            )
        )
    wood = {"density_kg_m3": 600, "restitution": 0.3, "friction": 0.4}
    return _scene(f"dice_{count}", bodies, 2, wood)


def collision_cloud(row: int = 3) -> Scene:
    """Cubes of 0.2 m thrown at their common centre, turning; no gravity, no ground."""
    rng = np.random.default_rng(23)
    bodies = []
    for i in range(row**3):
        place = 0.6 * (np.array([i % row, i // row % row, i // row**2]) - (row - 1) / 2)
        velocity = -1.5 * place + rng.uniform(-0.5, 0.5, 3)
        bodies.append(
            _box(
                f"box-{i}",
                [0.2] * 3,
                list(place),
                orientation_wxyz=_turn(rng),
                velocity_m_s=[float(x) for x in velocity],
                angular_velocity_rad_s=[float(x) for x in rng.uniform(-3, 3, 3)],
            )
        )
    wood = {"density_kg_m3": 600, "restitution": 0.5, "friction": 0.4}
    scene = _scene("collision_cloud", bodies, 2, wood, gravity_m_s2=[0, 0, 0])
    del scene["ground"]
    return scene


def stacked_pile(columns: int, layers: int, duration_s: float) -> Scene:
    """Cubes fall from a nearly aligned grid: gaps of 10 mm, 2 mm aside at random."""
    rng = np.random.default_rng(3)
    bodies = []
    for x in range(columns):
        for y in range(columns):
            for z in range(layers):
                aside = rng.uniform(-2e-3, 2e-3, 2)
                place = [
                    (EDGE_M + 0.02) * x + aside[0],
                    (EDGE_M + 0.02) * y + aside[1],
                    (EDGE_M + 0.01) * z + EDGE_M / 2 + 0.01,
                ]
                bodies.append(_box(f"box-{x}-{y}-{z}", [EDGE_M] * 3, place))
    wood = {"density_kg_m3": 1000, "restitution": 0, "friction": 0.5}
    return _scene(f"pile_{len(bodies)}", bodies, duration_s, wood)


def tumbled_pile(count: int, duration_s: float, seed: int = 7) -> Scene:
    """Cubes in random orientations fall from a loose grid into a pit."""
    rng = np.random.default_rng(seed)
    side = 5 * (count / 1000) ** (1 / 3)
    bodies = [
        _box(f"box-{i}", [EDGE_M] * 3, place, orientation_wxyz=_turn(rng))
        for i, place in enumerate(_loose_grid(count, side, 0.9))
    ]
    wood = {"density_kg_m3": 1000, "restitution": 0, "friction": 0.5}
    return _scene(f"tumbled_{count}", [*bodies, *_pit(side, 60)], duration_s, wood)


def tumbled_rest(count: int, duration_s: float) -> Scene:
    """The same cubes where they have come to lie (settle.py); speeds are 0."""
    scene = tumbled_pile(count, duration_s)
    with rest_table(scene["name"]).open(encoding="utf-8", newline="") as stream:
        poses = {
            row.pop("body"): [float(x) for x in row.values()] for row in csv.DictReader(stream)
        }
    for body in scene["bodies"]:
        if body["name"] in poses:
            pose = poses[body["name"]]
            turn = np.array(pose[3:])
            body["position_m"] = pose[:3]
            body["orientation_wxyz"] = [float(x) for x in turn / np.linalg.norm(turn)]
    scene["name"] += "_rest"
    return scene


def rest_table(pile: str) -> Path:
    return SCENES / f"{pile}_rest.csv"


def stones(count: int, duration_s: float) -> Scene:
    """Convex stones of some 0.3 m in random orientations fall into a pit."""
    rng = np.random.default_rng(11)
    side = 1.6 * (count / 100) ** (1 / 3)
    shape = {"mesh": STONE, "scale": 0.15}
    bodies = [
        {
            "name": f"stone-{i}",
            "shape": shape,
            "material": "wood",
            "position_m": place,
            "orientation_wxyz": _turn(rng),
        }
        for i, place in enumerate(_loose_grid(count, side, 0.36))
    ]
    rock = {"density_kg_m3": 2500, "restitution": 0, "friction": 0.5}
    return _scene(f"stones_{count}", [*bodies, *_pit(side, 20)], duration_s, rock)


def loose_stones(columns: int, layers: int, duration_s: float) -> Scene:
    """The same stones fall from a loose grid and spread on the ground; no walls."""
    rng = np.random.default_rng(13)
    bodies = [
        {
            "name": f"stone-{x}-{y}-{z}",
            "shape": {"mesh": STONE, "scale": 0.15},
            "material": "wood",
            "position_m": [0.36 * x, 0.36 * y, 0.2 + 0.36 * z],
            "orientation_wxyz": _turn(rng),
        }
        for x in range(columns)
        for y in range(columns)
        for z in range(layers)
    ]
    rock = {"density_kg_m3": 2500, "restitution": 0, "friction": 0.5}
    return _scene(f"loose_stones_{len(bodies)}", bodies, duration_s, rock)


def stone_mesh() -> str:
    """An OBJ file: the convex hull of points on an ellipsoid of half axes 1, 0.8 and 0.65 m."""
    rng = np.random.default_rng(2)
    points = rng.normal(size=(24, 3))
    points = points / np.linalg.norm(points, axis=1, keepdims=True) * [1, 0.8, 0.65]
    hull = ConvexHull(points)
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in points]
    for (a, b, c), normal in zip(hull.simplices, hull.equations[:, :3], strict=True):
        is_outward = np.cross(points[b] - points[a], points[c] - points[a]) @ normal > 0
        corners = (a, b, c) if is_outward else (a, c, b)
        lines.append("f " + " ".join(str(corner + 1) for corner in corners))
    return "\n".join(lines) + "\n"


def spheres(count: int, duration_s: float) -> Scene:
    """Spheres of 10 mm fall from a disturbed lattice into a square pit."""
    rng = np.random.default_rng(5)
    diameter = 0.01
    row = max(2, round((count / 2) ** (1 / 3)))
    spacing = 1.02 * diameter
    side = row * spacing
    bodies = []
    for i in range(count):
        cell = np.array([i % row, i // row % row, i // row**2]) + 0.5
        place = cell * spacing - [side / 2, side / 2, 0] + rng.uniform(-8e-5, 8e-5, 3)
        bodies.append(
            {
                "name": f"ball-{i}",
                "shape": {"sphere_radius_m": diameter / 2},
                "material": "wood",
                "position_m": [float(x) for x in place],
            }
        )
    glass = {"density_kg_m3": 2500, "restitution": 0.5, "friction": 0.5}
    return _scene(f"spheres_{count}", [*bodies, *_pit(side, 1)], duration_s, glass)


def sphere_cubes(count: int, duration_s: float) -> Scene:
    """Cubes of 30 mm, which method seed and LAMMPS make of 27 spheres of 10 mm, fall on a heap."""
    rng = np.random.default_rng(9)
    edge = 0.03
    row = max(2, round(count ** (1 / 3)))
    bodies = []
    for i in range(count):
        cell = np.array([i % row, i // row % row, i // row**2]) + 0.5
        place = cell * 1.2 * edge + [*rng.uniform(-2e-3, 2e-3, 2), 0]
        bodies.append(_box(f"cube-{i}", [edge] * 3, list(place)))
    glass = {"density_kg_m3": 2500, "restitution": 0.3, "friction": 0.5}
    return _scene(f"sphere_cubes_{count}", bodies, duration_s, glass)


def _loose_grid(count: int, side: float, rise: float) -> list[list[float]]:
    row = max(1, int(side / rise))
    return [
        [
            (i % row + 0.5) * side / row - side / 2,
            (i // row % row + 0.5) * side / row - side / 2,
            rise * (0.55 + i // row**2),
        ]
        for i in range(count)
    ]


def _turn(rng: np.random.Generator) -> list[float]:
    turn = rng.normal(size=4)
    return [float(x) for x in turn / np.linalg.norm(turn)]


def _pit(side: float, height: float) -> list[Body]:
    """Four fixed walls around a square of `side`."""
    thick = max(side / 2, 0.01)
    bodies = []
    for name, x, y in (("east", 1, 0), ("west", -1, 0), ("north", 0, 1), ("south", 0, -1)):
        away = side / 2 + thick / 2
        edges = [thick if x else side + 2 * thick, thick if y else side + 2 * thick, height]
        bodies.append(_box(name, edges, [x * away, y * away, height / 2], motion="fixed"))
    return bodies
