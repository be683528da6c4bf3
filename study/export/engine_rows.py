# SPDX-License-Identifier: MIT
"""The table `engine`: what the sidecar says of each clip's run, and what cost.csv says it costs."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

from verisim.study.export.rows import Row, Snapshot
from verisim.study.problems import Problem, StudyError

PARAMETERS = ("dt_s", "stiffness_n_m", "particle_size_m", "damping_ratio")
METRICS = (
    "max_penetration_m",
    "mean_penetration_m",
    "energy_residual_rel",
    "momentum_residual_rel",
    "num_particles",
    "max_contacts",
)
TOP = ("engine_version", "scene_sha256", "state_hash", "error_to_reference_m")
# column of the export → column of cost.csv
COSTS = {
    "cost_machine": "machine",
    "cost_build": "build",
    "cost_num_runs": "num_runs",
    "cpu_s_per_sim_s_median": "cpu_s_per_sim_s_median",
    "cpu_s_per_sim_s_min": "cpu_s_per_sim_s_min",
    "cpu_s_per_sim_s_q1": "cpu_s_per_sim_s_q1",
    "cpu_s_per_sim_s_q3": "cpu_s_per_sim_s_q3",
}


def engine(snapshot: Snapshot) -> list[Row]:
    """Returns one row per clip; cost cells are empty where cost.csv is absent or lacks the clip."""
    costs = read_costs(Path(snapshot.study["set_dir"]) / "cost.csv")
    return [engine_row(row, costs.get(row["name"], {})) for row in snapshot.stimuli]


def engine_row(stimulus: Row, cost: dict[str, str]) -> Row:
    sidecar: dict[str, Any] = json.loads(stimulus["provenance_json"])
    parameters = sidecar.get("parameters") or {}
    metrics = sidecar.get("metrics") or {}
    failed = sidecar.get("failed") or {}
    return {
        "source": "stimulus",
        "stimulus": stimulus["name"],
        "method": stimulus["method"],
        **{name: sidecar.get(name) for name in TOP},
        "failed_code": failed.get("code"),
        "failed_body": failed.get("body"),
        "failed_time_s": failed.get("time_s"),
        **{name: scalar(parameters.get(name)) for name in PARAMETERS},
        **{name: scalar(metrics.get(name)) for name in METRICS},
        **{name: cost.get(column) or None for name, column in COSTS.items()},
    }


def scalar(value: Any) -> Any:
    """A parameter per body or material is a list or mapping: it has no place in one cell."""
    return value if isinstance(value, str | int | float) else None


def read_costs(path: Path) -> dict[str, dict[str, str]]:
    """Returns cost.csv's row per stimulus, nothing if there is no such file."""
    if not path.is_file():
        return {}
    problems: list[Problem] = []
    costs: dict[str, dict[str, str]] = {}
    with path.open(newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        missing = [c for c in ("stimulus", *COSTS.values()) if c not in (reader.fieldnames or [])]
        hint = "measure again: `verisim stimuli cost SET -o DIR`"
        if missing:
            raise StudyError([Problem(f"{path}:1", f"columns missing: {', '.join(missing)}", hint)])
        for line, row in enumerate(reader, start=2):
            if row["stimulus"] in costs:
                where = f"{path}:{line}"
                problems.append(Problem(where, f"{row['stimulus']!r} is listed twice", hint))
            costs[row["stimulus"]] = row
    if problems:
        raise StudyError(problems)
    return costs
