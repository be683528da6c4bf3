# SPDX-License-Identifier: MIT
"""The files of the maps: predictions before the runs, every run as a row, outcomes when complete.

runs.csv grows by a row per run and is what a stopped bench goes on from; a row that was cut off is
dropped. outcomes.csv stands only beside a complete bench.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from verisim.bench.files import append_row, table_text, whole_rows, write_whole
from verisim.bench.stability.cells import Pose, Prediction, StabilityMap

PREDICTION_COLUMNS = ("map", "method", "x", "y", "predicted", "limit", "value", "inputs_sha256")
RUN_COLUMNS = (
    "inputs_sha256",
    "engine_build",
    "map",
    "method",
    "x",
    "y",
    "predicted_before",
    "outcome",
    "engine_code",
    "time_s",
    "message",
    "steps",
    "dt_s",
    "cpu_s",
    "max_penetration_m",
    "restitution",
)
OUTCOME_COLUMNS = ("map", "method", "x", "y", "predicted", "limit", "right", *RUN_COLUMNS[7:])


@dataclass(frozen=True)
class Cell:
    """One place of a map, as it will be run."""

    of: StabilityMap
    x: float
    y: float
    pose: Pose
    prediction: Prediction
    inputs_sha256: str


def make_cell(of: StabilityMap, x: float, y: float) -> Cell:
    pose = of.pose(x, y)
    return Cell(of, x, y, pose, of.predict(x, y), _inputs_hash(pose))


def _inputs_hash(pose: Pose) -> str:
    """Of everything that an outcome depends on beside the engine: scene, sampling, rule."""
    rule = Path(__file__).with_name("outcome.py").read_bytes()
    inputs = {
        "scene": pose.scene,
        "sample_interval_s": pose.sample_interval_s,
        "judge": vars(pose.judge),
        "rule": hashlib.sha256(rule).hexdigest(),
    }
    return hashlib.sha256(json.dumps(inputs, sort_keys=True).encode()).hexdigest()


def write_predictions(file: Path, cells: Sequence[Cell]) -> str:
    """Writes the file whole, before any run; returns its sha256."""
    rows = [
        {
            "map": cell.of.key,
            "method": cell.of.method,
            "x": cell.x,
            "y": cell.y,
            "predicted": cell.prediction.words,
            "limit": cell.prediction.limit,
            "value": f"{cell.prediction.value:.6g}",
            "inputs_sha256": cell.inputs_sha256,
        }
        for cell in cells
    ]
    text = table_text(PREDICTION_COLUMNS, rows)
    write_whole(file, text)
    return hashlib.sha256(text.encode()).hexdigest()


class RunLog:
    """runs.csv: rows by inputs and engine."""

    def __init__(self, file: Path, engine_build: str) -> None:
        self.file, self.engine_build = file, engine_build
        rows = whole_rows(file, RUN_COLUMNS)
        # Without the cut-off row, and with the columns of today.
        write_whole(file, table_text(RUN_COLUMNS, rows))
        self.rows = {
            row["inputs_sha256"]: row for row in rows if row["engine_build"] == engine_build
        }

    def add(self, cell: Cell, outcome: dict[str, Any]) -> None:
        row = {
            "inputs_sha256": cell.inputs_sha256,
            "engine_build": self.engine_build,
            "map": cell.of.key,
            "method": cell.of.method,
            "x": cell.x,
            "y": cell.y,
            "predicted_before": cell.prediction.words,
            **{key: "" if value is None else value for key, value in outcome.items()},
        }
        append_row(self.file, RUN_COLUMNS, row)
        self.rows[cell.inputs_sha256] = {key: str(value) for key, value in row.items()}


def outcome_rows(cells: Sequence[Cell], log: RunLog) -> list[dict[str, Any]]:
    """What outcomes.csv holds: prediction and outcome of every cell."""
    return [
        {
            **log.rows[cell.inputs_sha256],
            "x": cell.x,
            "y": cell.y,
            "map": cell.of.key,
            "method": cell.of.method,
            "predicted": cell.prediction.words,
            "limit": cell.prediction.limit,
            "right": is_right(cell, log),
        }
        for cell in cells
    ]


def is_right(cell: Cell, log: RunLog) -> bool:
    return log.rows[cell.inputs_sha256]["outcome"] in cell.prediction.codes
