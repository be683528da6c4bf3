# SPDX-License-Identifier: MIT
"""Pairs and adaptive tracks over HTTP: what was shown, what comes next, what may be sent."""

from __future__ import annotations

import csv
import json
import shutil
import sqlite3
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from study_tools import (
    PAIRS,
    TRACKS,
    Person,
    Server,
    new_id,
    presentation,
    response,
    write_study,
)

from verisim.study.export import export
from verisim.study.server import simulate
from verisim.study.server.observer import Traits


@pytest.fixture(scope="module")
def pairs(set_dir: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    study = write_study(tmp_path_factory.mktemp("pairs"), PAIRS)
    with Server(study, set_dir, tmp_path_factory.mktemp("db") / "pairs.db") as server:
        yield server


def played(sha256: str, position: int) -> dict[str, Any]:
    times = {"onset_ms": 10.0 + position, "first_frame_ms": 3.0, "ended_ms": 345.0}
    frames = {"frames_total": 10, "frames_dropped": position, "stall_count": 0, "stall_ms": 0}
    return {"position": position, "sha256": sha256, "num_plays": 1, **times, **frames}


def answer(person: Person, which: float | None, clips: list[str] | None = None) -> Any:
    trial = person.trial()
    shown = clips or [clip["sha256"] for clip in trial["clips"]]
    given = [response("realism", 4), response("speed", 3), response("fun", 1)]
    given.append(response("which", which, None if which else "not_sure"))
    if which:
        given.append(response("sure", 2))
    return person.post(
        "trials",
        submission_id=new_id(),
        trial_id=trial["trial_id"],
        presentation=presentation(
            clips=[played(sha256, i) for i, sha256 in enumerate(shown)], start_skew_ms=-1.5
        ),
        responses=given,
    )


def test_a_pair_is_two_clips_of_which_one_is_the_reference(pairs: Server) -> None:
    person = Person.ready(pairs)
    layouts: Counter[str] = Counter()
    while (step := person.next())["step"] == "trial":
        trial = step["trial"]
        layouts[trial["layout"]] += 1
        assert len(trial["clips"]) == 2 and trial["reversed"] == []
        assert trial["conditions"]["sure"]["value"] == "not_sure"
        assert answer(person, 1 if layouts.total() % 2 else None).status_code == 201
    assert layouts == {"sequential": 2, "side_by_side": 2}
    expected = pairs.query(
        "SELECT expected_json FROM trial WHERE participant_id = ?", person.participant_id
    )
    assert all('"question": "which"' in text for (text,) in expected)


def test_each_clip_is_stored_as_it_was_shown(pairs: Server, tmp_path: Path) -> None:
    person = Person.ready(pairs)
    planned = [clip["sha256"] for clip in person.trial()["clips"]]
    assert answer(person, 2, planned[::-1]).status_code == 201  # shown the other way round
    export(Path(pairs.db), tmp_path / "tree")
    path = tmp_path / "tree/data/study-mini_table-showings_data.csv"
    with path.open(newline="") as file:
        rows = [r for r in csv.DictReader(file) if r["participant_id"] == person.participant_id]
    assert [(r["position"], r["planned_position"], r["stimulus_sha256"]) for r in rows] == [
        ("0", "1", planned[1]),
        ("1", "0", planned[0]),
    ]
    assert [r["frames_dropped"] for r in rows] == ["0", "1"]


def test_clips_of_another_trial_are_refused(pairs: Server) -> None:
    person = Person.ready(pairs)
    foreign = answer(person, 1, ["f" * 64, person.trial()["clips"][1]["sha256"]])
    assert foreign.status_code == 422 and "is no clip of this trial" in foreign.text
    assert answer(person, 1).status_code == 201


@pytest.fixture(scope="module")
def tracks_set(set_dir: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The mini clips with numbers for levels: 1 (undistorted), 1.5 and so on."""
    directory = tmp_path_factory.mktemp("tracks") / "mini"
    shutil.copytree(set_dir, directory)
    with (set_dir / "manifest.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    sizes = iter(("1.2", "1.5", "1", "2", "3", "1"))
    for row in rows:
        row["factor_size"] = next(sizes) if row["role"] == "test" else ""
    with (directory / "manifest.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    return directory


@pytest.fixture(scope="module")
def adaptive(tracks_set: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    study = write_study(tmp_path_factory.mktemp("adaptive"), TRACKS)
    with Server(study, tracks_set, tmp_path_factory.mktemp("db") / "tracks.db") as server:
        yield server


def judge(person: Person, plausible: float) -> None:
    given = [response("realism", 4), response("speed", 3), response("fun", 1)]
    reply = person.post(
        "trials",
        submission_id=new_id(),
        trial_id=person.trial()["trial_id"],
        presentation=presentation(),
        responses=[*given, response("plausible", plausible)],
    )
    assert reply.status_code == 201, reply.text


def levels_shown(server: Server, person: Person) -> list[str]:
    names = server.query(
        "SELECT stimulus.name FROM trial JOIN stimulus ON stimulus_id = stimulus_a "
        "WHERE participant_id = ? AND track IS NOT NULL ORDER BY trial_index",
        person.participant_id,
    )
    sizes = {"drop__stiffness-low": "1.2", "drop__stiffness-mid": "1.5",
             "stack__stiffness-low": "2", "stack__stiffness-mid": "3"}  # fmt: skip
    return [sizes[name.removesuffix("__s1")] for (name,) in names]


def test_the_track_goes_down_while_faults_are_seen_and_up_while_not(adaptive: Server) -> None:
    keen, dull = Person.ready(adaptive), Person.ready(adaptive)
    for person, plausible in ((keen, 0), (dull, 1)):
        while person.next()["step"] == "trial":
            before = person.trial()
            assert person.trial() == before  # a reload chooses nothing anew
            judge(person, plausible)
    seen, missed = levels_shown(adaptive, keen), levels_shown(adaptive, dull)
    assert len(seen) == len(missed) == 6
    assert seen[-1] == "1.2" and missed[-1] == "3"


def test_the_clip_of_a_track_is_chosen_one_at_a_time(adaptive: Server) -> None:
    person = Person.ready(adaptive)
    empty = "SELECT count(*) FROM trial WHERE participant_id = ? AND stimulus_a IS NULL"
    judge(person, 1)  # practice
    before = adaptive.query(empty, person.participant_id)[0][0]
    judge(person, 1)
    assert before - adaptive.query(empty, person.participant_id)[0][0] <= 1
    assert before >= 4


def test_raters_with_a_stated_threshold_pull_the_track_to_it(
    tracks_set: Path, tmp_path: Path
) -> None:
    study = write_study(tmp_path / "study", TRACKS.replace("trials: 6", "trials: 16"))
    means = {}
    for threshold in (0.3, 1.4):
        db = tmp_path / f"{threshold}.db"
        traits = Traits(spread=0, false_alarm=0.02, thresholds={"up": threshold})
        simulate(study, tracks_set, db, 6, 1, traits=traits)
        export(db, tmp_path / f"x{threshold}")
        path = tmp_path / f"x{threshold}/data/study-mini_table-ratings_data.csv"
        with path.open(newline="") as file:
            sizes = [
                float(row["factor_size"])
                for row in csv.DictReader(file)
                if row["track"] == "up" and row["question"] == "plausible"
            ]
        means[threshold] = sum(sizes) / len(sizes)
    # Magnitudes are log2(size): 0.26, 0.58, 1, 1.58. Measured means: 1.33 and 2.5.
    assert means[0.3] < 1.7 < 2.0 < means[1.4]


def test_tracks_of_pairs_choose_a_clip_and_its_reference(tracks_set: Path, tmp_path: Path) -> None:
    order = TRACKS[TRACKS.index("order:") : TRACKS.index("exclude:")]
    text = PAIRS[: PAIRS.index("order:")] + order + PAIRS[PAIRS.index("exclude:") :]
    text = text.replace("question: plausible", "question: which\n  pairs: {with: reference}")
    db = tmp_path / "pairs.db"
    simulate(write_study(tmp_path / "study", text), tracks_set, db, 3, 1)
    with sqlite3.connect(db) as connection:
        rows = connection.execute(
            "SELECT a.reference, a.name, b.reference, b.name, expected_json FROM trial "
            "JOIN stimulus a ON a.stimulus_id = stimulus_a "
            "JOIN stimulus b ON b.stimulus_id = stimulus_b WHERE track = 'up'"
        ).fetchall()
    assert len(rows) == 18
    for reference_a, name_a, reference_b, name_b, expected in rows:
        right = json.loads(expected)["is"]
        assert (right, reference_a) == (2.0, name_b) or (right, reference_b) == (1.0, name_a)
