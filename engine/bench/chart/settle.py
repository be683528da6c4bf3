# SPDX-License-Identifier: MIT
"""Makes scenes/NAME_rest.csv: where the boxes of a tumbled pile have come to lie.

    .venv/bin/python -m verisim.bench.chart.settle tumbled_250

Method xpbd lets them fall in few substeps and settle in more, for it is the cheapest of ours in a
pile that falls. The boxes are larger by CLEARANCE_M while they do, and the few that overlap by more
in the end are pushed apart, so that those of the scene start without a contact: every engine makes
its own, and nobody's rest is among the poses. They are committed, so that every build starts alike.
A thousand boxes take a quarter of an hour.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from verisim import engine
from verisim.bench.chart import generated
from verisim.bench.chart.overlap import box_depths, near_pairs, solids_of
from verisim.bench.chart.trial import Scene
from verisim.bench.files import write_whole
from verisim.engine import PoseLog


@dataclass(frozen=True)
class Stage:
    """A stretch of the fall."""

    duration_s: float
    substeps: int  # of a frame
    stops_first: bool = False  # speeds are set to 0


FALL = (Stage(5, 4), Stage(1, 10), Stage(1, 20))
CALM = (*(Stage(0.5, 80, stops_first=True),) * 6, *(Stage(0.25, 160, stops_first=True),) * 3)
CLEARANCE_M = 1.5e-3
MAX_NUM_PUSHES = 300
PUSH = 0.6  # of an overlap, for each of two
PILES = {f"tumbled_{count}": count for count in (250, 1000)}
Say = Callable[[str], None]


def settle(scene: Scene, say: Say) -> PoseLog:
    """Poses at the end of all stages, each of which goes on where the one before it ended."""
    poses: PoseLog | None = None
    for stage in (*FALL, *CALM):
        if poses is not None:
            scene = continued(scene, poses, stop=stage.stops_first)
        poses = _run({**scene, "duration_s": stage.duration_s}, stage.substeps)
        speed = np.linalg.norm(poses.linear_velocity_m_s[-1], axis=1).mean()
        depth = deepest(scene, poses)
        say(f"{stage}: mean speed {speed:.2g} m/s, deepest overlap {1e3 * depth:.2g} mm")
    assert poses is not None
    return poses


def _run(scene: Scene, substeps: int) -> PoseLog:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "pile.yaml"
        file.write_text(json.dumps(scene), "utf-8")
        settings = {"physics.method": "xpbd", "physics.substeps": substeps}
        return engine.simulate(file, settings, num_threads=1).poses


def continued(scene: Scene, poses: PoseLog, *, stop: bool) -> Scene:
    """The scene with its free bodies as they are at the end of the log."""
    states = {
        "position_m": poses.position_m,
        "orientation_wxyz": poses.orientation_wxyz,
        "velocity_m_s": poses.linear_velocity_m_s * (not stop),
        "angular_velocity_rad_s": poses.angular_velocity_rad_s * (not stop),
    }
    row_of = {name: row for row, name in enumerate(poses.names)}
    bodies = []
    for body in scene["bodies"]:
        if body.get("motion", "free") == "free":
            row = row_of[body["name"]]
            body = body | {key: values[-1, row].tolist() for key, values in states.items()}
        bodies.append(body)
    return {**scene, "bodies": bodies}


def deepest(scene: Scene, poses: PoseLog) -> float:
    """Overlap (m) at the end of the log."""
    solids = solids_of(scene, Path())
    depths = solids.depths(poses.position_m[-1], poses.orientation_wxyz[-1])
    return float(depths.max(initial=0))


def parted(scene: Scene, poses: PoseLog) -> PoseLog:
    """The end of the log with the few boxes that still overlap pushed apart: from each other along
    the line of their centres, from walls and the ground straight away. Raises RuntimeError where
    that does not end."""
    solids = solids_of(scene, Path())
    place, turn = poses.position_m[-1].copy(), poses.orientation_wxyz[-1]
    axes = Rotation.from_quat(turn[:, [1, 2, 3, 0]]).as_matrix()
    for _ in range(MAX_NUM_PUSHES):
        reach = (np.abs(axes[:, 2]) * solids.halves).sum(axis=1)  # downwards
        sunk = np.where(solids.is_free, reach - place[:, 2], 0)
        place[:, 2] += np.maximum(sunk, 0)
        pairs = near_pairs(place, solids.radii)
        pairs = pairs[solids.is_free[pairs].any(axis=1)]
        depth = box_depths(place, axes, solids.halves, pairs)
        for (a, b), overlap in zip(pairs[depth > 0], depth[depth > 0], strict=True):
            away = place[b] - place[a]
            if not (solids.is_free[a] and solids.is_free[b]):
                wall = b if solids.is_free[a] else a
                side = int((np.abs(away) - solids.halves[wall])[:2].argmax())
                away = away * (np.arange(3) == side)
            push = PUSH * overlap * away / np.linalg.norm(away)
            place[a] -= push * solids.is_free[a]
            place[b] += push * solids.is_free[b]
        if max(depth.max(initial=0), sunk.max()) <= 0:
            return PoseLog(
                poses.names, poses.time_s[-1:], place[None], turn[None],
                poses.linear_velocity_m_s[-1:], poses.angular_velocity_rad_s[-1:],
            )  # fmt: skip
    raise RuntimeError(f"boxes overlap after {MAX_NUM_PUSHES} pushes")


def table(poses: PoseLog, names: Sequence[str]) -> str:
    """The last poses of these bodies; to 0.01 mm and 0.00001 of a turn's quaternion."""
    row_of = {name: row for row, name in enumerate(poses.names)}
    lines = ["body,x_m,y_m,z_m,w,x,y,z"]
    for name in names:
        row = row_of[name]
        numbers = [*poses.position_m[-1, row], *poses.orientation_wxyz[-1, row]]
        lines.append(",".join([name, *(f"{number:.5f}" for number in numbers)]))
    return "\n".join(lines) + "\n"


def swollen(scene: Scene) -> Scene:
    """The scene with free boxes that are larger by CLEARANCE_M."""
    bodies = []
    for body in scene["bodies"]:
        if body.get("motion", "free") == "free":
            edges = [edge + CLEARANCE_M for edge in body["shape"]["box_m"]]
            body = body | {"shape": {"box_m": edges}}
        bodies.append(body)
    return {**scene, "bodies": bodies}


def main() -> None:
    parser = argparse.ArgumentParser(description="Where the boxes of a tumbled pile lie.")
    parser.add_argument("pile", choices=PILES)
    name = parser.parse_args().pile
    scene = generated.tumbled_pile(PILES[name], 1)
    poses = parted(scene, settle(swollen(scene), partial(print, flush=True)))
    names = [body["name"] for body in scene["bodies"] if body.get("motion") != "fixed"]
    write_whole(generated.rest_table(name), table(poses, names))


if __name__ == "__main__":
    main()
