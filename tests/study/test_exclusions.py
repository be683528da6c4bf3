# SPDX-License-Identifier: MIT
"""Every exclusion rule flags whom it should, at its limit, and nobody else."""

from __future__ import annotations

import csv
from pathlib import Path

from study_tools import STUDY, Person, Server, presentation, response, trial_body, write_study

from verisim.study.export import export

RULES = """exclude: {missed_catch: 1, median_rt_below_ms: 400, equal_answers_run: 3,
  frames_dropped_share: 0.1, hidden_ms: 2000}
"""
ALL_RULES = STUDY.replace("exclude: {missed_catch: 1, median_rt_below_ms: 400}\n", RULES)


def take_part(server: Server, *, dropped: int, hidden_ms: float, rt_ms: float, bored: bool) -> str:
    """Answers everything; 10 frames each, bored: the same to each clip, also to the catch clip."""
    person = Person.ready(server)
    i = 0
    while (step := person.next())["step"] == "trial":
        trial = step["trial"]
        is_catch = trial["trial_kind"] == "catch"
        realism = 7 if bored else 1 if is_catch else 4 + i % 3
        given = [response("realism", realism), response("speed", 3), response("fun", 50)]
        body = trial_body(
            trial["trial_id"],
            presentation=presentation(frames_dropped=dropped, hidden_ms=hidden_ms),
            responses=[{**one, "rt_ms": rt_ms} for one in given],
        )
        assert person.post("trials", **body).status_code == 201
        i += 1
    return person.participant_id


def test_each_rule_flags_the_careless_and_spares_the_careful(set_dir: Path, tmp_path: Path) -> None:
    study = write_study(tmp_path / "study", ALL_RULES)
    with Server(study, set_dir, tmp_path / "study.db") as server:
        # Exactly at a limit that must be passed: 1 of 10 frames, 8 x 250 ms, 400 ms.
        careful = take_part(server, dropped=1, hidden_ms=250, rt_ms=400, bored=False)
        careless = take_part(server, dropped=2, hidden_ms=251, rt_ms=399, bored=True)
    export(tmp_path / "study.db", tmp_path / "tree")
    table = tmp_path / "tree" / "data" / "study-mini_table-exclusions_data.csv"
    with table.open(newline="") as file:
        rows = {(row["participant_id"], row["rule"]): row for row in csv.DictReader(file)}
    seen = {rule: float(row["value"]) for (who, rule), row in rows.items() if who == careless}
    assert seen == {
        "missed_catch": 1,
        "median_rt_below_ms": 399,
        "equal_answers_run": 7,  # practice does not count
        "frames_dropped_share": 0.2,
        "hidden_ms": 8 * 251,
    }
    assert {row["flagged"] for (who, _), row in rows.items() if who == careless} == {"1"}
    assert {row["flagged"] for (who, _), row in rows.items() if who == careful} == {"0"}
