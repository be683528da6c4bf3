# SPDX-License-Identifier: MIT
"""Runs one cell in a worker process."""

from __future__ import annotations

import json
import tempfile
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

from verisim.bench.stability.cells import Pose

LIMIT_S = 600.0  # CPU time of one cell


class TooSlow(Exception):
    """The cell used up its time."""


def run_cell(pose: Pose, report: Any) -> dict[str, Any]:
    """What runs.csv holds of the outcome. Importable by name, as workers need it."""
    from verisim import engine
    from verisim.bench.stability.outcome import judge

    start = time.process_time()

    def note(done: float, total: float) -> None:
        report(done / total)
        if time.process_time() - start > LIMIT_S:
            raise TooSlow

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"{pose.scene['name']}.yaml"
        file.write_text(json.dumps(pose.scene), "utf-8")  # YAML too
        try:
            run = engine.simulate(
                file, sample_interval_s=pose.sample_interval_s, num_threads=1, progress=note
            )
        except TooSlow:
            return unfinished(f"not done after {LIMIT_S:g} CPU s", time.process_time() - start)
    outcome = asdict(judge(run, pose.judge))
    outcome["outcome"] = outcome.pop("code")
    return outcome


def unfinished(message: str, cpu_s: float | None = None) -> dict[str, Any]:
    """The row of a cell that gave no outcome."""
    return {"outcome": "?", "message": message, "cpu_s": cpu_s}
