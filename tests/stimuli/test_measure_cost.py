# SPDX-License-Identifier: MIT
"""Cost is measured serially, interleaved and at least five times per setting."""

from __future__ import annotations

import csv
import statistics
from pathlib import Path

import pytest
from small_sets import BALL_SET, write_set

from verisim.stimuli import measure_cost

WITH_PRACTICE = BALL_SET + "roles: {practice: [{scene: ball}]}\n"
IDS = ["ball__stiffness-low__s1", "ball__stiffness-high__s1"]


def read(file: Path) -> list[dict[str, str]]:
    with file.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_rounds_are_interleaved_and_the_first_only_warms_up(library: Path) -> None:
    seen: list[tuple[float, float]] = []
    file = measure_cost(write_set(library, WITH_PRACTICE), library / "out", repeats=6,
                        progress=lambda done, total: seen.append((done, total)))  # fmt: skip
    runs = read(library / "out" / "cost_runs.csv")
    assert [run["stimulus"] for run in runs] == IDS * 6
    assert [int(run["round"]) for run in runs] == [r for r in range(1, 7) for _ in IDS]
    assert seen[-1] == (14, 14)
    assert {row["num_runs"] for row in read(file)} == {"6"}


def test_the_summary_follows_from_the_single_runs(library: Path) -> None:
    file = measure_cost(write_set(library, WITH_PRACTICE), library / "out")
    runs = read(library / "out" / "cost_runs.csv")
    rows = read(file)
    assert [row["stimulus"] for row in rows] == IDS
    for row in rows:
        costs = [float(r["cpu_s_per_sim_s"]) for r in runs if r["stimulus"] == row["stimulus"]]
        assert len(costs) == 5 and min(costs) > 0
        assert float(row["cpu_s_per_sim_s_median"]) == statistics.median(costs)
        assert float(row["cpu_s_per_sim_s_min"]) == min(costs)
        assert float(row["cpu_s_per_sim_s_q1"]) == sorted(costs)[1]
        assert float(row["cpu_s_per_sim_s_q3"]) == sorted(costs)[3]
        assert row["machine"].endswith("cores") and row["build"].startswith("0.")
        assert (row["steps"], float(row["dt_s"])) == ("150", 1e-3)
    assert [float(row["stiffness_n_m"]) for row in rows] == [500, 5000]


def test_time_left_never_cuts_below_five_rounds(library: Path) -> None:
    file = measure_cost(write_set(library, BALL_SET), library / "out", repeats=50, max_minutes=0)
    assert {row["num_runs"] for row in read(file)} == {"5"}


def test_fewer_than_five_repeats_are_refused(library: Path) -> None:
    with pytest.raises(ValueError, match="repeats: saw 4; allowed: 5 or more"):
        measure_cost(library / "sets" / "small.yaml", library / "out", repeats=4)
