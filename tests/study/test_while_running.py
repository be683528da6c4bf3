# SPDX-License-Identifier: MIT
"""What may happen beside participants at work: exports, other clocks, guessed and replayed keys."""

from __future__ import annotations

import csv
import os
import sqlite3
import threading
from collections import Counter
from datetime import UTC, datetime
from pathlib import Path

from study_tools import Person, Server, error_code, new_id, trial_body

from verisim.analysis.load import check_export
from verisim.study.export import export
from verisim.study.server.lists import earlier


def test_an_export_while_answers_come_in_shows_one_moment(
    set_dir: Path, study_path: Path, tmp_path: Path
) -> None:
    with Server(study_path, set_dir, tmp_path / "busy.db") as server:
        stop = threading.Event()

        def rate() -> None:
            while not stop.is_set():
                person = Person.ready(server)
                while not stop.is_set() and person.next()["step"] == "trial":
                    person.answer_next()

        threads = [threading.Thread(target=rate) for _ in range(3)]
        for thread in threads:
            thread.start()
        try:
            for i in range(4):
                export(tmp_path / "busy.db", tmp_path / f"x{i}")
        finally:
            stop.set()
            for thread in threads:
                thread.join()
    for i in range(4):
        assert check_export(tmp_path / f"x{i}") == []
        path = tmp_path / f"x{i}/data/study-mini_table-ratings_data.csv"
        with path.open(newline="") as file:
            answers = Counter(row["presentation_id"] for row in csv.DictReader(file))
        assert set(answers.values()) <= {3}  # a trial is exported whole or not at all


def test_times_are_utc_wherever_the_server_stands(
    set_dir: Path, study_path: Path, tmp_path: Path
) -> None:
    before = os.environ.get("TZ")
    os.environ["TZ"] = "Pacific/Kiritimati"  # 14 hours ahead
    try:
        with Server(study_path, set_dir, tmp_path / "tz.db") as server:
            person = Person.arrive(server)
            stored = server.query("SELECT enrolled_utc FROM participant")[0][0]
            # A page whose clock and zone are elsewhere says so; nothing is computed from it.
            zone = server.query("SELECT tz_offset_min FROM session")[0][0]
    finally:
        os.environ.pop("TZ") if before is None else os.environ.update(TZ=before)
    assert zone == -60 and person.token
    assert abs((datetime.fromisoformat(stored) - datetime.now(UTC)).total_seconds()) < 60


def test_a_clock_that_jumps_back_loses_no_place(
    set_dir: Path, study_path: Path, tmp_path: Path
) -> None:
    with Server(study_path, set_dir, tmp_path / "jump.db") as server:
        person = Person.ready(server)
        person.answer_next()
        with sqlite3.connect(tmp_path / "jump.db") as db:  # as if stored by a clock ahead of time
            db.execute("UPDATE session SET last_seen_utc = '2090-01-01T00:00:00.000Z'")
            db.execute("UPDATE trial SET answered_utc = '2090-01-01T00:00:00.000Z' "
                       "WHERE answered_utc IS NOT NULL")  # fmt: skip
        place = person.trial()["trial_index"]
        assert place == 1
        assert person.answer_next().status_code == 201
        other = Person.arrive(server)  # whoever seems to come from the future keeps the list
        lists = server.query("SELECT list_no FROM assignment ORDER BY list_no")
        assert lists == [(0,), (1,)] and other.token
        assert person.finish()["step"] == "thanks"
    export(tmp_path / "jump.db", tmp_path / "x")
    assert check_export(tmp_path / "x") == []
    assert earlier("2026-01-01T00:30:00.000Z", 60) == "2025-12-31T23:30:00.000Z"


def test_guessed_foreign_and_replayed_keys_open_nothing(
    set_dir: Path, study_path: Path, tmp_path: Path
) -> None:
    with Server(study_path, set_dir, tmp_path / "keys.db") as server:
        person, other = Person.ready(server), Person.ready(server)
        guesses = ("a" * 43, person.token[:-1], person.token + "A", person.participant_id, "")
        for guess in guesses:
            for path in ("trials", "events", "withdraw", "stop", "end_questions", "screen"):
                with server.client(guess) as client:
                    reply = client.post(f"/api/{path}", json={"submission_id": new_id()})
                # The body is looked at first; what is wrong with it is no secret.
                assert reply.status_code == (401 if path == "stop" else reply.status_code)
                assert reply.status_code in (401, 422), (guess, path)
                assert person.token not in reply.text
        foreign = person.post("trials", **trial_body(other.trial()["trial_id"]))
        assert foreign.status_code == 403 and error_code(foreign) == "not_yours"
        body = trial_body(person.trial()["trial_id"])
        assert person.post("trials", **body).status_code == 201
        stolen = other.post("trials", **{**body, "trial_id": other.trial()["trial_id"]})
        assert stolen.status_code == 409 and error_code(stolen) == "submission_id_taken"
        person.finish()
        late = person.post("trials", **trial_body(body["trial_id"]))
        assert late.status_code == 409 and error_code(late) == "already_answered"
        tokens = b"".join(p.read_bytes() for p in tmp_path.glob("keys.db*"))
        assert person.token.encode() not in tokens
