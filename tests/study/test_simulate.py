# SPDX-License-Identifier: MIT
"""Scripted raters: complete, marked as simulated, and led by the clip's visible error alone."""

from __future__ import annotations

import json
import sqlite3
from pathlib import Path
from statistics import mean

import pytest
from study_tools import Person, Server

from verisim.study.problems import StudyError
from verisim.study.server import simulate
from verisim.study.server.observer import visible_error
from verisim.study.server.stimulus_set import load_stimulus_set

PARTICIPANTS = 6


@pytest.fixture(scope="module")
def simulated(
    study_path: Path, set_dir: Path, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, list[tuple[int, int]]]:
    db = tmp_path_factory.mktemp("simulated") / "study.db"
    progress: list[tuple[int, int]] = []
    simulate(
        study_path, set_dir, db, PARTICIPANTS, 3, on_progress=lambda *step: progress.append(step)
    )
    return db, progress


def query(db: Path, sql: str) -> list[tuple[object, ...]]:
    with sqlite3.connect(db) as connection:
        return connection.execute(sql).fetchall()


def test_scripted_raters_complete_the_study_and_are_marked(
    simulated: tuple[Path, list[tuple[int, int]]],
) -> None:
    db, progress = simulated
    assert (
        query(db, "SELECT source, state FROM participant")
        == [("simulated", "completed")] * PARTICIPANTS
    )
    assert query(db, "SELECT count(*) FROM response") == [(PARTICIPANTS * 8 * 3,)]
    assert progress[0] == (0, PARTICIPANTS)
    assert [done for done, _ in progress[1:]] == list(range(1, PARTICIPANTS + 1))
    assert all("simulated" in str(body) for (body,) in query(db, "SELECT body FROM comment"))


def test_the_traits_of_each_rater_are_stored_with_the_data(
    simulated: tuple[Path, list[tuple[int, int]]],
) -> None:
    rows = query(simulated[0], "SELECT detail_json FROM event WHERE kind = 'observer'")
    traits = [json.loads(str(detail)) for (detail,) in rows]
    assert len(traits) == PARTICIPANTS
    assert {"bias", "sensitivity", "noise", "lapse", "side_bias", "slope"} <= set(traits[0])
    assert len({trait["bias"] for trait in traits}) == PARTICIPANTS


def test_worse_clips_get_worse_ratings(simulated: tuple[Path, list[tuple[int, int]]]) -> None:
    rows = query(
        simulated[0],
        "SELECT name, value FROM response JOIN question USING (question_id) "
        "JOIN trial USING (trial_id) JOIN stimulus ON stimulus_id = stimulus_a "
        "WHERE key = 'realism' AND trial_kind = 'test'",
    )
    means = {
        level: mean(float(str(value)) for name, value in rows if f"stiffness-{level}" in str(name))
        for level in ("low", "mid", "high")
    }
    # measured with seed 3: low 2.8, mid 4.7, high 6.3 of 7
    assert means["low"] + 0.8 < means["mid"] < means["high"] - 0.8, means


def test_the_same_seed_gives_the_same_answers(
    simulated: tuple[Path, list[tuple[int, int]]], study_path: Path, set_dir: Path, tmp_path: Path
) -> None:
    simulate(study_path, set_dir, tmp_path / "again.db", PARTICIPANTS, 3)
    answers = (
        "SELECT list_no, trial_index, stimulus_a, question_id, value, rt_ms FROM response "
        "JOIN trial USING (trial_id) JOIN assignment USING (participant_id) ORDER BY 1, 2, 4"
    )
    assert query(tmp_path / "again.db", answers) == query(simulated[0], answers)


def test_visible_error_ignores_cost_and_grows_with_the_fault(set_dir: Path) -> None:
    stimuli = {stimulus.name: stimulus for stimulus in load_stimulus_set(set_dir).stimuli}
    errors = {name: visible_error(stimulus) for name, stimulus in stimuli.items()}
    assert errors["drop__stiffness-high__s1"] == 0
    assert errors["drop__stiffness-mid__s1"] == pytest.approx(1 - (10 / 15) * (50 / 60))
    assert errors["drop__stiffness-low__s1"] == pytest.approx(1 - (10 / 40) * (50 / 110))
    assert errors["vanish__stiffness-mid__s1"] > 0.95  # catch


def test_people_and_scripted_raters_share_a_server_without_mixing(
    study_path: Path, set_dir: Path, tmp_path: Path
) -> None:
    with Server(study_path, set_dir, tmp_path / "study.db", simulate_key="sesame") as server:
        Person.arrive(server, source="simulated", simulate_key="sesame")
        Person.arrive(server, source="link")
        notice = server.client().get("/api/study").json()["simulated_notice"]
        assert "simulated" in notice
        assert server.query("SELECT source FROM participant ORDER BY source") == [
            ("link",),
            ("simulated",),
        ]
        with pytest.raises(StudyError, match="in use by another server"):
            simulate(study_path, set_dir, tmp_path / "study.db", 1, 1)
        assert b"sesame" not in (tmp_path / "study.db-wal").read_bytes()


def test_no_raters_are_refused(study_path: Path, set_dir: Path, tmp_path: Path) -> None:
    with pytest.raises(StudyError, match="0 is not allowed"):
        simulate(study_path, set_dir, tmp_path / "study.db", 0, 1)
