# SPDX-License-Identifier: MIT
"""Depths of overlaps by poses alone, against cases that can be worked out by hand."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from verisim.bench.chart.generated import STONE, stone_mesh
from verisim.bench.chart.overlap import overlaps, solids_of
from verisim.engine import inspect_shape

UPRIGHT = [1.0, 0, 0, 0]


def body(name: str, shape: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"name": name, "shape": shape, "material": "any", **more}


def scene(*bodies: dict[str, Any], ground: bool = False) -> dict[str, Any]:
    plane = {"plane": {"normal": [0, 0, 1], "offset_m": 0}, "material": "any"}
    return {"bodies": list(bodies), **({"ground": plane} if ground else {})}


def depths(content: dict[str, Any], places: list[list[float]], turns: Any = None) -> list[float]:
    turns = [UPRIGHT] * len(places) if turns is None else turns
    solids = solids_of(content, Path())
    return sorted(solids.depths(np.array(places, dtype=float), np.array(turns, dtype=float)))


def test_boxes_of_unlike_sizes_overlap_by_the_least_of_all_axes() -> None:
    content = scene(body("a", {"box_m": [1, 1, 1]}), body("b", {"box_m": [2, 2, 0.2]}))
    assert depths(content, [[0, 0, 0], [0.3, 0.1, 0.59]]) == pytest.approx([0.01])
    assert depths(content, [[0, 0, 0], [0, 0, 0.61]]) == []


def test_an_edge_across_an_edge_is_seen() -> None:
    # Both turned by 45 degrees about crossed axes: edges meet when centres are sqrt(2) apart.
    half = math.pi / 8
    turns = [[math.cos(half), math.sin(half), 0, 0], [math.cos(half), 0, math.sin(half), 0]]
    content = scene(body("a", {"box_m": [1, 1, 1]}), body("b", {"box_m": [1, 1, 1]}))
    found = depths(content, [[0, 0, 0], [0, 0, math.sqrt(2) - 0.01]], turns)
    assert found == pytest.approx([0.01])


def test_the_floor_and_equal_boxes_count_as_before() -> None:
    found = overlaps(
        np.array([[0, 0, 0.49], [0, 0, 1.48]]), np.array([UPRIGHT] * 2), np.full(3, 0.5)
    )
    assert sorted(found) == pytest.approx([0.01, 0.01])


def test_spheres_are_exact_between_each_other_in_walls_and_in_the_ground() -> None:
    ball = {"sphere_radius_m": 0.1}
    wall = body("wall", {"box_m": [1, 10, 10]}, motion="fixed")
    content = scene(body("a", ball), body("b", ball), wall, ground=True)
    found = depths(content, [[0.095, 0, 0.099], [0.285, 0, 0.2], [-0.5, 0, 0]])
    assert found == pytest.approx([0.001, 0.005])
    assert depths(content, [[0.2, 0, 0.3], [0.38, 0, 0.3], [-0.5, 0, 0]]) == pytest.approx([0.02])


def test_fixed_bodies_may_overlap_each_other() -> None:
    wall = {"box_m": [1, 1, 1]}
    content = scene(
        body("a", wall, motion="fixed"), body("b", wall, motion="fixed"), body("c", wall)
    )
    assert depths(content, [[0, 0, 0], [0.5, 0, 0], [5, 0, 0]]) == []


def test_meshes_overlap_as_the_boxes_that_they_are(tmp_path: Path) -> None:
    corners = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    faces = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
    for a, b, c, d in faces:
        lines += [f"f {a} {b} {c}", f"f {a} {c} {d}"]
    (tmp_path / "cube.obj").write_text("\n".join(lines) + "\n")
    content = scene(body("a", {"mesh": "cube.obj"}), body("b", {"mesh": "cube.obj"}), ground=True)
    solids = solids_of(content, tmp_path)
    places, turns = np.array([[0, 0, 0.49], [0.1, 0.2, 1.47]]), np.array([UPRIGHT] * 2)
    assert sorted(solids.depths(places, turns)) == pytest.approx([0.01, 0.02])


def test_the_stone_is_a_closed_convex_mesh(tmp_path: Path) -> None:
    (tmp_path / STONE).write_text(stone_mesh())
    found = inspect_shape(tmp_path / STONE)
    assert found["closed"]
    assert found["volume_m3"] == pytest.approx(1.6, abs=0.3)  # of an ellipsoid's 2.2: few corners
