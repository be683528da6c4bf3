# SPDX-License-Identifier: MIT
"""The points of every scene whose table lies in a folder, whichever call of the bench made them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from verisim.bench.chart.bench_scene import BenchScene
from verisim.bench.chart.contestants import Entry
from verisim.bench.chart.front import Point
from verisim.bench.chart.tables import columns_of, point_of
from verisim.bench.files import whole_rows

IDENTITY = ("inputs_sha256", "build", "machine")
Points = dict[tuple[str, str], list[Point]]  # by scene and measure
Rows = list[dict[str, str]]


def written_points(folder: Path, scenes: Sequence[BenchScene]) -> Points:
    """By scene and measure; of each setting the newest runs. Measures against a contestant's own
    finest run are left out: their points need more than a table."""
    found: Points = {}
    for scene in scenes:
        groups = newest_runs(whole_rows(folder / f"{scene.key}.csv", columns_of(scene)))
        for measure in scene.measures:
            if not measure.is_own:
                found[scene.key, measure.key] = [
                    point_of(Entry(method, setting, {}), rows, measure)
                    for (method, setting), rows in groups.items()
                ]
    return found


def newest_runs(rows: Rows) -> dict[tuple[str, str], Rows]:
    """The rows of each setting that share inputs, build and machine with its last one."""
    groups: dict[tuple[str, str], Rows] = {}
    for row in rows:
        groups.setdefault((row["method"], row["setting"]), []).append(row)
    return {
        name: [row for row in group if all(row[key] == group[-1][key] for key in IDENTITY)]
        for name, group in groups.items()
    }
