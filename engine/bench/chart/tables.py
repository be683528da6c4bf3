# SPDX-License-Identifier: MIT
"""SCENE.csv: every run of a scene as a row; what a stopped bench goes on from."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

from verisim.bench.chart.bench_scene import BenchScene
from verisim.bench.chart.contestants import Entry
from verisim.bench.chart.front import Point
from verisim.bench.chart.trial import Measure, scene_document
from verisim.bench.files import append_row, table_text, whole_rows, write_whole

FACTS = (
    "scene",
    "method",
    "setting",
    "overrides",
    "run",
    "machine",
    "build",
    "commit",
    "inputs_sha256",
    "cpu_s_per_sim_s",
    "cost_counts",
    "simulated_s",
    "steps",
    "dt_s",
    "state_hash",
    "version",
    "took_s",
)
RULES = (
    "errors.py",
    "overlap.py",
    "closed_forms.py",
    "resting.py",
    "closed_system.py",
    "run_trial.py",
)


class RunTable:
    """The rows of one scene on this machine with today's engine; others in the file are kept only
    where they are of another machine or contestant."""

    def __init__(self, file: Path, scene: BenchScene) -> None:
        self.file = file
        self.columns = columns_of(scene)
        self.rows = whole_rows(file, self.columns)
        write_whole(file, table_text(self.columns, self.rows))

    def of(self, identity: dict[str, str]) -> list[dict[str, str]]:
        """The runs made with this identity (inputs, build, machine), in order."""
        return [row for row in self.rows if all(row[key] == identity[key] for key in identity)]

    def add(self, row: dict[str, Any]) -> None:
        full = {column: _text(row.get(column)) for column in self.columns}
        append_row(self.file, self.columns, full)
        self.rows.append(full)


def columns_of(scene: BenchScene) -> tuple[str, ...]:
    return (*FACTS, *(measure.key for measure in scene.measures), "failed")


def _text(value: Any) -> str:
    return "" if value is None else str(value)


def inputs_hash(scene: BenchScene, file: Path, entry: Entry) -> str:
    """Of everything that a run depends on beside the engine: scene, meshes, setting, measures."""
    digest = hashlib.sha256(file.read_bytes())
    for body in scene_document(file)["bodies"]:
        if "mesh" in body["shape"]:
            digest.update((file.parent / body["shape"]["mesh"]).read_bytes())
    digest.update(json.dumps(dict(entry.overrides), sort_keys=True, default=str).encode())
    digest.update(json.dumps([measure.key for measure in scene.measures]).encode())
    digest.update(f"{entry.method} {scene.warm_up_s}".encode())
    digest.update(rules_hash().encode())
    return digest.hexdigest()


@cache
def rules_hash() -> str:
    digest = hashlib.sha256()
    for name in RULES:
        file = Path(__file__).with_name(name)
        if file.is_file():
            digest.update(file.read_bytes())
    return digest.hexdigest()


@cache
def peers_hash() -> str:
    """Of the adapters and drivers; the engine's own version is in each row."""
    digest = hashlib.sha256()
    folder = Path(__file__).parent.parent / "peers"
    files = (file for file in folder.rglob("*") if file.is_file() and file.suffix != ".pyc")
    for file in sorted(files):
        digest.update(str(file.relative_to(folder)).encode() + file.read_bytes())
    return digest.hexdigest()[:16]


Rows = Sequence[dict[str, str]]


def point_of(entry: Entry, rows: Rows, measure: Measure, finest: Rows = ()) -> Point:
    """A setting's runs as one point; without any it counts as failed. finest: the runs of the
    contestant's own reference, where the measure is against that."""
    counted = [row for row in rows if row["cost_counts"] == "True"] or rows[:1]
    costs = tuple(float(row["cpu_s_per_sim_s"] or "nan") for row in counted)
    costs = tuple(cost for cost in costs if math.isfinite(cost) and cost > 0)
    judged = next((row for row in rows if row[measure.key] != "" or row["failed"]), None)
    if judged is None:
        return Point(entry.method, entry.setting, math.inf, costs, "not run")
    error = float(judged[measure.key] or "inf")
    failed = judged["failed"]
    if measure.is_own and not failed:
        own = own_value(finest, measure)
        error = math.inf if own is None else abs(error / own - 1)
        failed = "no finest run to compare with" if own is None else ""
    if not failed and not math.isfinite(error):
        failed = "no finite error"
    return Point(entry.method, entry.setting, error, costs, failed)


def own_value(finest: Rows, measure: Measure) -> float | None:
    """What the finest run of a contestant gave; None if there is none that holds."""
    judged = next((row for row in finest if row[measure.key] != ""), None)
    if judged is None or judged["failed"] or not math.isfinite(float(judged[measure.key])):
        return None
    return float(judged[measure.key])
