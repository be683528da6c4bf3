# SPDX-License-Identifier: MIT
"""What each setting costs to compute: serial runs of the physics alone, into cost.csv."""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from verisim.stimuli.check import scene_problems
from verisim.stimuli.engine_build import engine_build
from verisim.stimuli.expand import Stimulus, expand
from verisim.stimuli.manifest import write_csv
from verisim.stimuli.problems import SetError
from verisim.stimuli.set_file import load_set

FEWEST_REPEATS = 5
COST_COLUMNS = (
    "stimulus",
    "method",
    "machine",
    "build",
    "num_runs",
    "cpu_s_per_sim_s_median",
    "cpu_s_per_sim_s_min",
    "cpu_s_per_sim_s_q1",
    "cpu_s_per_sim_s_q3",
    "steps",
    "dt_s",
    "stiffness_n_m",
    "particle_size_m",
)
RUN_COLUMNS = ("run", "round", "stimulus", "cpu_s_per_sim_s")

Progress = Callable[[float, float], None]  # (runs done, runs in all)


def measure_cost(
    set_file: Path | str,
    out_dir: Path | str,
    repeats: int = FEWEST_REPEATS,
    max_minutes: float | None = None,
    progress: Progress | None = None,
) -> Path:
    """Measures the set's test stimuli and writes cost.csv (and every single run, cost_runs.csv).

    One process, one thread, physics only. A first round warms up and does not count; then rounds
    are interleaved over the stimuli (A B C … A B C …), so that a slow minute of the machine hits
    all alike. With `max_minutes` the last rounds are left out once that time has passed, never
    one of the first five. Returns the path of cost.csv. Raises SetError, ValueError.
    """
    if repeats < FEWEST_REPEATS:
        raise ValueError(f"repeats: saw {repeats}; allowed: {FEWEST_REPEATS} or more")
    stimulus_set = load_set(set_file)
    stimuli = [stimulus for stimulus in expand(stimulus_set) if stimulus.role == "test"]
    if problems := scene_problems(stimulus_set, stimuli):
        raise SetError(problems)
    summaries: dict[str, dict[str, Any]] = {}
    runs: list[dict[str, Any]] = []
    total = (repeats + 1) * len(stimuli)
    started = time.monotonic()
    for round_index in range(repeats + 1):
        minutes = (time.monotonic() - started) / 60
        if round_index > FEWEST_REPEATS and max_minutes is not None and minutes > max_minutes:
            break
        for i, stimulus in enumerate(stimuli):
            summaries[stimulus.id] = summary = _run(stimulus)
            if round_index > 0:
                runs.append(
                    {
                        "run": len(runs) + 1,
                        "round": round_index,
                        "stimulus": stimulus.id,
                        "cpu_s_per_sim_s": summary["cpu_s_per_sim_s"],
                    }
                )
            if progress:
                progress(round_index * len(stimuli) + i + 1, total)
    if progress:
        progress(total, total)
    directory = Path(out_dir)
    directory.mkdir(parents=True, exist_ok=True)
    write_csv(directory / "cost_runs.csv", RUN_COLUMNS, runs)
    rows = [_row(stimulus, summaries[stimulus.id], runs) for stimulus in stimuli]
    write_csv(directory / "cost.csv", COST_COLUMNS, rows)
    return directory / "cost.csv"


def _run(stimulus: Stimulus) -> dict[str, Any]:
    from verisim import engine

    run = engine.simulate(stimulus.scene_file, stimulus.overrides, num_threads=1)
    return {**run.parameters, **run.summary}


def _row(stimulus: Stimulus, summary: dict[str, Any], runs: list[dict[str, Any]]) -> dict[str, Any]:
    costs = [
        run["cpu_s_per_sim_s"]
        for run in runs
        if run["stimulus"] == stimulus.id and run["cpu_s_per_sim_s"] is not None
    ]
    row: dict[str, Any] = {
        "stimulus": stimulus.id,
        "method": summary["method"],
        "machine": machine(),
        "build": "{version} {build:.12}".format(**engine_build()),
        "num_runs": len(costs),
    }
    if costs:
        q1, median, q3 = statistics.quantiles(costs, n=4, method="inclusive")
        row |= {
            "cpu_s_per_sim_s_median": median,
            "cpu_s_per_sim_s_min": min(costs),
            "cpu_s_per_sim_s_q1": q1,
            "cpu_s_per_sim_s_q3": q3,
        }
    settings = ("steps", "dt_s", "stiffness_n_m", "particle_size_m")
    return row | {key: "" if summary.get(key) is None else summary[key] for key in settings}


def machine() -> str:
    """Processor and number of cores, e.g. `Some CPU @ 2.50GHz, 2 cores`."""
    model = "unknown processor"
    try:
        for line in Path("/proc/cpuinfo").read_text("utf-8").splitlines():
            if line.startswith("model name"):
                model = line.partition(":")[2].strip()
                break
    except OSError:
        pass
    return f"{model}, {os.cpu_count()} cores"
