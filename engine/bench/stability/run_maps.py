# SPDX-License-Identifier: MIT
"""Predicts, runs and draws the maps: resumable, and no outcome before its prediction is on disk."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from verisim.bench.files import only_bench, table_text, write_whole
from verisim.bench.stability.catalogue import choose
from verisim.bench.stability.cells import StabilityMap
from verisim.bench.stability.run_cell import run_cell, unfinished
from verisim.bench.stability.score import SCORE_COLUMNS, Score, score_cells
from verisim.bench.stability.tables import (
    OUTCOME_COLUMNS,
    Cell,
    RunLog,
    make_cell,
    outcome_rows,
    write_predictions,
)
from verisim.stimuli.engine_build import engine_build
from verisim.stimuli.workers import run_tasks

Progress = Callable[[float, float], None]  # (cells done, cells in all)
Say = Callable[[str], None]


@dataclass(frozen=True)
class Result:
    directory: Path
    page: Path
    num_run: int
    num_kept: int
    num_late: int  # cells whose prediction differs from the one written before their run
    scores: list[Score]  # of each map, the last one of all


def run_stability(
    directory: Path | str,
    *,
    quick: bool = False,
    maps: Sequence[str] | None = None,
    methods: Sequence[str] | None = None,
    jobs: int | None = None,
    progress: Progress | None = None,
    say: Say | None = None,
) -> Result:
    """Runs the stability maps into `directory`: predictions.csv first, then runs.csv row by row,
    at the end outcomes.csv, scores.csv, figures and index.html.

    A cell that was run with the same inputs and the same engine is not run again. Raises
    BenchError for unknown names, or if another bench writes to the directory.
    """
    chosen = choose(maps, methods)
    directory = Path(directory)
    with only_bench(directory):
        for stale in ("outcomes.csv", "scores.csv", "index.html"):
            (directory / stale).unlink(missing_ok=True)
        if say:
            say(f"{directory}: predicting every cell before the first is run")
        cells = [cell for each in chosen for cell in _cells(each, quick)]
        predictions_sha256 = write_predictions(directory / "predictions.csv", cells)
        engine = engine_build()
        log = RunLog(directory / "runs.csv", engine["build"])
        todo = [cell for cell in cells if cell.inputs_sha256 not in log.rows]
        _run(todo, log, len(cells), jobs or len(os.sched_getaffinity(0)), progress)
        scores = score_cells(cells, log)
        late = sum(
            log.rows[cell.inputs_sha256]["predicted_before"] != cell.prediction.words
            for cell in cells
        )
        facts = {
            "quick": quick,
            "predictions_sha256": predictions_sha256,
            "engine_version": engine["version"],
            "engine_build": engine["build"],
            "cells": len(cells),
            "predictions_changed_after_run": late,
        }
        write_whole(directory / "run_log.json", json.dumps(facts, indent=2) + "\n")
        page = _show(directory, chosen, cells, log, scores, facts)
    return Result(directory, page, len(todo), len(cells) - len(todo), late, scores)


def _cells(of: StabilityMap, quick: bool) -> list[Cell]:
    grid = of.quick if quick else of.full
    return [make_cell(of, x, y) for y in grid.y for x in grid.x]


def _run(
    cells: Sequence[Cell], log: RunLog, total: int, jobs: int, progress: Progress | None
) -> None:
    num_kept = total - len(cells)
    shares = [0.0] * len(cells)
    if progress:
        progress(num_kept, total)
    for event in run_tasks([cell.pose for cell in cells], run_cell, jobs):
        if event.kind == "fraction":
            shares[event.index] = event.value
        elif event.kind in ("done", "failed"):
            shares[event.index] = 1.0
            value = event.value if event.kind == "done" else unfinished(event.value)
            log.add(cells[event.index], value)
        if progress:
            progress(num_kept + sum(shares), total)


def _show(
    directory: Path,
    chosen: Sequence[StabilityMap],
    cells: Sequence[Cell],
    log: RunLog,
    scores: Sequence[Score],
    facts: dict[str, Any],
) -> Path:
    """Writes figures, scores, outcomes and the page."""
    # Slow to import, and the workers need none of it.
    from verisim.bench.stability.draw import draw_map
    from verisim.bench.stability.page import write_page

    figures = directory / "figures"
    figures.mkdir(exist_ok=True)
    drawings = [
        draw_map(each, [cell for cell in cells if cell.of is each], log, figures) for each in chosen
    ]
    rows = outcome_rows(cells, log)
    write_whole(directory / "scores.csv", table_text(SCORE_COLUMNS, map(vars, scores)))
    write_whole(directory / "outcomes.csv", table_text(OUTCOME_COLUMNS, rows))
    page = directory / "index.html"
    write_page(page, chosen, drawings, scores, rows, facts)
    return page
