# SPDX-License-Identifier: MIT
"""Tumbled piles at rest: nothing overlaps at first, and what made them keeps to the pile."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from verisim.bench.chart import generated
from verisim.bench.chart.overlap import solids_of
from verisim.bench.chart.settle import CLEARANCE_M, PILES, continued, parted, swollen, table
from verisim.engine import PoseLog

UPRIGHT = [1.0, 0, 0, 0]


def at(places: Any, turns: Any = None) -> PoseLog:
    place = np.asarray([places], dtype=float)
    turn = np.tile(UPRIGHT, (1, len(places), 1)) if turns is None else np.asarray([turns])
    still = np.ones_like(place)
    return PoseLog([f"b{n}" for n in range(len(places))], np.zeros(1), place, turn, still, still)


def scene(*edges: list[float], fixed: int = 0) -> dict[str, Any]:
    """Boxes, the last `fixed` of which are walls, on the ground."""
    bodies = [
        {"name": f"b{n}", "shape": {"box_m": each}, "material": "wood"}
        | ({"motion": "fixed"} if n >= len(edges) - fixed else {})
        for n, each in enumerate(edges)
    ]
    return {"bodies": bodies, "ground": {"plane": {"normal": [0, 0, 1]}, "material": "wood"}}


@pytest.mark.parametrize(("pile", "count"), PILES.items())
def test_a_pile_at_rest_starts_without_contacts_and_close_together(pile: str, count: int) -> None:
    made = generated.tumbled_rest(count, 1)
    boxes = [body for body in made["bodies"] if body.get("motion") != "fixed"]
    assert (made["name"], len(boxes)) == (f"{pile}_rest", count)
    place = np.array([body["position_m"] for body in made["bodies"]])
    turn = np.array([body.get("orientation_wxyz", UPRIGHT) for body in made["bodies"]])
    depth = solids_of(made, Path()).depths(place, turn)
    assert depth.max(initial=0) < 1e-5  # numbers are written to 0.01 mm; measured below 4e-6
    swelled = solids_of(swollen(made), Path()).depths(place, turn)
    assert (
        swelled.size > 1.2 * count
    )  # within the clearance they hold each other; measured 1.4, 1.9
    assert swelled.max() < 3 * CLEARANCE_M


def test_a_stage_goes_on_where_and_as_fast_as_the_last_one_ended() -> None:
    made = scene([1, 1, 1], [9, 9, 1], fixed=1)
    poses = at([[1, 2, 3], [0, 0, -5]])
    moving, still = continued(made, poses, stop=False), continued(made, poses, stop=True)
    assert moving["bodies"][0]["position_m"] == [1, 2, 3]
    assert moving["bodies"][0]["velocity_m_s"] == [1, 1, 1]
    assert still["bodies"][0]["angular_velocity_rad_s"] == [0, 0, 0]
    assert moving["bodies"][1] == made["bodies"][1]


def test_boxes_that_overlap_are_pushed_apart_and_walls_stay() -> None:
    made = scene([1, 1, 1], [1, 1, 1], [1, 1, 1], [1, 20, 9], fixed=1)
    # Two on each other, one of them in the ground; one in the wall, far from the wall's centre.
    log = at([[3, 0, 0.49], [3, 0, 1.48], [0.98, 8, 0.6], [0, 0, 4]])
    found = parted(made, log)
    place = found.position_m[-1]
    assert solids_of(made, Path()).depths(place, found.orientation_wxyz[-1]).size == 0
    assert place[3].tolist() == [0, 0, 4]
    assert np.abs(place - log.position_m[-1]).max() < 0.05
    assert place[2] == pytest.approx([1, 8, 0.6], abs=0.005)  # straight away from the wall


def test_the_table_holds_the_named_bodies_alone() -> None:
    text = table(at([[1, 2, 3], [0, 0, -5.0000049]]), ["b1"])
    assert (
        text
        == "body,x_m,y_m,z_m,w,x,y,z\nb1,0.00000,0.00000,-5.00000,1.00000,0.00000,0.00000,0.00000\n"
    )
