# SPDX-License-Identifier: MIT
"""Means and intervals per clip, cohorts, flow and rank correlations."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from make_export import make_tree

from verisim.analysis.exclude import choose_cohort, participant_flow, presentation_flow
from verisim.analysis.load import load_export
from verisim.analysis.scores import (
    mean_interval,
    rated_cells,
    reference_differences,
    repeat_differences,
)
from verisim.analysis.tradeoff import join_engine, rank_correlation


def test_t_interval_is_the_textbook_one() -> None:
    # t(0.975, 4) = 2.776445 from printed tables; sd of 1..5 = sqrt(2.5).
    mean, sd, low, high = mean_interval(np.array([5.0, 1, 4, 2, 3]))
    half = 2.776445 * math.sqrt(2.5) / math.sqrt(5)
    assert (mean, sd) == (3.0, pytest.approx(math.sqrt(2.5)))
    assert (low, high) == (pytest.approx(3 - half, abs=1e-6), pytest.approx(3 + half, abs=1e-6))


def test_one_answer_has_a_mean_and_no_interval() -> None:
    mean, *rest = mean_interval(np.array([4.0]))
    assert mean == 4.0
    assert all(math.isnan(value) for value in rest)


def test_t_interval_covers_the_true_mean_19_times_in_20() -> None:
    rng = np.random.default_rng(11)
    hits = 0
    for _ in range(1000):
        _, _, low, high = mean_interval(rng.normal(4, 1.3, 8))
        hits += low <= 4 <= high
    # Measured 950 with this seed; three standard errors of 1000 draws are 21.
    assert abs(hits - 950) <= 21


def test_only_first_showings_of_test_clips_count(tmp_path: Path) -> None:
    tree = make_tree(3)
    for kind, row in zip(
        ("practice", "catch", "repeat"), tree.tables["ratings"][::4], strict=False
    ):
        row["trial_kind"] = kind
    export = load_export(tree.write(tmp_path / "export"))
    people = choose_cohort(export).analysed
    assert len(rated_cells(export, people)) == len(tree.tables["ratings"]) - 3


def test_people_who_did_not_complete_are_counted_and_not_analysed(tmp_path: Path) -> None:
    tree = make_tree(8)
    states = ["active", "withdrawn", "declined", "enrolled"]
    for person, state in zip(tree.tables["participants"], states, strict=False):
        person |= {"state": state, "completed_utc": ""}
        if state in ("declined", "enrolled"):
            person["consented_utc"] = ""
    export = load_export(tree.write(tmp_path / "export"))
    cohort = choose_cohort(export)
    steps = {step.name: step for step in participant_flow(export, cohort)}
    assert {name: step.count for name, step in steps.items()} == {
        "enrolled": 8,
        "consented": 6,
        "completed": 4,
        "analysed": 4,
        "without flagged": 4,
    }
    assert steps["consented"].lost == "1 declined, 1 left before answering"
    assert steps["completed"].lost == "1 unfinished, 1 withdrew"
    last = presentation_flow(export, cohort)[-1]
    assert (last.count, last.lost) == (48, "48 of people who did not complete")


def test_a_flag_splits_the_analysis_and_removes_nobody(sound_export: Path) -> None:
    cohort = choose_cohort(load_export(sound_export))
    assert len(cohort.analysed) == 12
    assert cohort.flagged == {"P002"}
    assert {name: len(people) for name, people in cohort.sets().items()} == {
        "all": 12,
        "without flagged": 11,
    }


def test_differences_pair_a_clip_with_its_reference_within_each_person(tmp_path: Path) -> None:
    tree = make_tree(4)
    person_level = {"P001": 0, "P002": 1, "P003": 2, "P004": 3}
    for row in tree.tables["ratings"]:
        if row["question"] == "collision":
            soft = row["factor_stiffness"] == "1e3"
            row["value"] = person_level[row["participant_id"]] + (1 if soft else 3)
    tree.tables["ratings"] = [
        row
        for row in tree.tables["ratings"]
        if (row["participant_id"], row["stimulus"]) != ("P004", "bounce__stiffness-1e5__s1")
    ]
    export = load_export(tree.write(tmp_path / "export"))
    ratings = rated_cells(export, choose_cohort(export).analysed)
    rows = reference_differences(ratings, export.tables["stimuli"], "all")
    rows = rows[rows["question"] == "collision"].set_index("stimulus")
    soft, hard = rows.loc["bounce__stiffness-1e3__s1"], rows.loc["bounce__stiffness-1e4__s1"]
    # People differ by up to 3 points, which pairing takes out; P004 never rated the reference.
    assert (soft["n"], soft["mean"], soft["sd"]) == (3, -2.0, 0.0)
    assert hard["mean"] == 0.0
    assert "bounce__stiffness-1e5__s1" not in rows.index


def test_repeated_clips_give_the_distance_between_two_answers(tmp_path: Path) -> None:
    tree = make_tree(2)
    tables = tree.tables
    shown = tables["presentations"][0]
    again = shown | {"presentation_id": "again", "trial_kind": "repeat", "trial_index": 12}
    tables["presentations"].append(again)
    first = [row for row in tables["ratings"] if row["presentation_id"] == shown["presentation_id"]]
    for row in first:
        row["value"] = 3
        tables["ratings"].append(row | again | {"value": 5})
    export = load_export(tree.write(tmp_path / "export"))
    differences = repeat_differences(export, choose_cohort(export).analysed)
    assert list(differences["n_pairs"]) == [1, 1, 1, 1]
    assert list(differences["mean_absolute_difference"]) == [2.0] * 4


def test_rank_correlation_is_exact_for_a_monotone_relation(sound_export: Path) -> None:
    export = load_export(sound_export)
    stimuli = export.tables["engine"].query("failed_code == ''")
    scores = stimuli[["stimulus"]].assign(
        question="realism", mean=-np.log(stimuli["energy_residual_rel"]), ci_low=0.0, ci_high=0.0
    )
    result = rank_correlation(join_engine(export, scores), "energy_residual_rel")
    assert result["n"] == 11
    assert result["rho"] == pytest.approx(-1.0)
