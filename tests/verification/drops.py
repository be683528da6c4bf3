# SPDX-License-Identifier: MIT
"""Seeded drops of tests/data/drop_corpus, and runs of scenes in processes with a CPU limit."""

from __future__ import annotations

import json
import multiprocessing
import resource
import signal
import time
from dataclasses import dataclass, field
from functools import cache
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
from ruamel.yaml import YAML

from verisim import engine
from verisim.pose_log import PoseLog

FOLDER = Path(__file__).parent.parent / "data" / "drop_corpus"
DROP_M = 1.0
DURATION_S = 1.5
# What half of the drops fall onto: a free box that stands on the floor.
SUPPORT_M = (0.6, 0.6, 0.2)


@cache
def corpus() -> dict[str, Any]:
    content: dict[str, Any] = YAML(typ="safe").load(FOLDER / "corpus.yaml")
    return content


def _shape(shape: dict[str, Any]) -> dict[str, Any]:
    if "mesh" not in shape:
        return shape
    return {**shape, "mesh": str((FOLDER / shape["mesh"]).resolve())}


def _falling(
    name: str, entry: dict[str, Any], place: list[float], rng: np.random.Generator
) -> dict[str, Any]:
    turn = rng.normal(size=4)
    return {
        "name": name,
        "shape": _shape(entry["shape"]),
        "material": "falling",
        "position_m": place,
        "orientation_wxyz": (turn / np.linalg.norm(turn)).tolist(),
        "angular_velocity_rad_s": rng.uniform(-6, 6, 3).tolist(),
    }


def drop_scene(body: str, seed: int) -> dict[str, Any]:
    """Even seeds fall onto the floor, odd ones onto a box. Physics are left at their defaults."""
    rng = np.random.default_rng([seed, sorted(corpus()).index(body)])
    entry = corpus()[body]
    onto_box = seed % 2 == 1
    height = DROP_M + entry["reach_m"] + (SUPPORT_M[2] if onto_box else 0)
    aside = rng.uniform(-0.2, 0.2, 2) if onto_box else np.zeros(2)
    bodies = [_falling(body, entry, [*aside.tolist(), height], rng)]
    if "beside" in entry:
        other = entry["beside"]
        way = entry["reach_m"] + 1.1 * other["reach_m"]
        bodies.append(_falling("little", other, [aside[0] + way, aside[1], height], rng))
    if onto_box:
        bodies.append(
            {
                "name": "support",
                "shape": {"box_m": list(SUPPORT_M)},
                "material": "still",
                "position_m": [0, 0, SUPPORT_M[2] / 2],
            }
        )
    density, restitution, friction = (
        rng.uniform(*bounds) for bounds in ((200, 8000), (0, 0.9), (0, 0.8))
    )
    falling = {"density_kg_m3": density, "restitution": restitution, "friction": friction}
    return {
        "schema": 1,
        "name": f"drop-{body}-{seed}",
        "duration_s": DURATION_S,
        "materials": {"falling": falling, "still": {**falling, "density_kg_m3": 2000}},
        "bodies": bodies,
        "ground": {"plane": {"normal": [0, 0, 1], "offset_m": 0}, "material": "still"},
    }


@dataclass
class Outcome:
    """What one run gave. `code` is also `timeout`, or `crash` if the process died."""

    name: str
    code: str | None = None
    body: str | None = None
    step: int = 0
    time_s: float = 0
    message: str = ""
    wall_s: float = 0
    cpu_s_per_sim_s: float = 0
    late_cpu_s_per_sim_s: float = 0  # over the last quarter of the run
    residual: float = 0
    metrics: dict[str, Any] = field(default_factory=dict)
    poses: PoseLog | None = None

    def __str__(self) -> str:
        if self.code is None:
            return f"{self.name}: ok, {self.cpu_s_per_sim_s:.3g} CPU s/s, {self.residual:.1e}"
        where = f"body {self.body}, step {self.step}, {self.time_s:.4g} s"
        return f"{self.name}: {self.code}, {where}; {self.message} [{self.wall_s:.0f} s]"


def _simulate(scene: str, overrides: list[str], limit_s: int, end: Connection) -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (limit_s, limit_s))
    late: list[tuple[float, float]] = []  # simulated and CPU time, in the last quarter

    def note(done: float, total: float) -> None:
        if done >= 0.75 * total:
            late.append((done, time.process_time()))

    run = engine.simulate(scene, overrides, progress=note)
    at_rest = 0.0
    if len(late) > 1:
        at_rest = (late[-1][1] - late[0][1]) / (late[-1][0] - late[0][0])
    end.send((run.summary, run.poses, at_rest))


def run_scenes(
    scenes: list[Path],
    limit_s: int,
    *,
    num_processes: int = 1,
    overrides: list[str] | None = None,
) -> list[Outcome]:
    """Each scene in a process of its own, which is ended after limit_s of CPU time."""
    waiting, running, outcomes = list(scenes), [], []
    while waiting or running:
        while waiting and len(running) < num_processes:
            scene = waiting.pop(0)
            here, there = multiprocessing.Pipe(duplex=False)
            process = multiprocessing.Process(
                target=_simulate, args=(str(scene), overrides or [], limit_s, there)
            )
            process.start()
            there.close()
            running.append((scene, process, here, time.monotonic()))
        for job in list(running):
            scene, process, here, start = job
            wall = time.monotonic() - start
            outcome = Outcome(scene.stem, wall_s=wall)
            if not here.poll(0.02):
                continue
            has_result = _read(here, outcome)
            process.join()
            if process.exitcode in (-signal.SIGXCPU, -signal.SIGKILL):
                outcome.code, outcome.message = "timeout", f"not done after {limit_s} CPU s"
            elif not has_result:
                outcome.code, outcome.message = "crash", f"exit code {process.exitcode}"
            running.remove(job)
            outcomes.append(outcome)
    return outcomes


def _read(here: Connection, outcome: Outcome) -> bool:
    try:
        summary, outcome.poses, outcome.late_cpu_s_per_sim_s = here.recv()
    except EOFError:
        return False
    outcome.metrics = summary["metrics"]
    outcome.cpu_s_per_sim_s = summary["cpu_s_per_sim_s"] or 0
    outcome.residual = summary["metrics"]["energy_residual_rel"]
    if summary["failed"]:
        failed = summary["failed"]
        outcome.code, outcome.body = failed["code"], failed["body"]
        outcome.step, outcome.time_s = failed["step"], failed["time_s"]
        outcome.message = failed["message"]
    return True


def write_scene(folder: Path, content: dict[str, Any]) -> Path:
    file = folder / f"{content['name']}.yaml"
    file.write_text(json.dumps(content))  # YAML too
    return file


def write_drops(folder: Path, drops: list[tuple[str, int]]) -> list[Path]:
    return [write_scene(folder, drop_scene(body, seed)) for body, seed in drops]
