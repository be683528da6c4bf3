# SPDX-License-Identifier: MIT
"""Who gets in and what they are given: quotas, lists, links, outside ids, modes."""

from __future__ import annotations

import sqlite3
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from study_tools import BETWEEN, STUDY, Person, Server, error_code, session_body, write_study

from verisim.study.problems import StudyError
from verisim.study.server.links import close_links, make_links
from verisim.study.server.open_study import open_study
from verisim.study.server.researcher import at_work_on


def enrol(server: Server, **changes: Any) -> Any:
    with server.client() as client:
        return client.post("/api/sessions", json=session_body(**changes))


def cells(server: Server) -> Counter[str]:
    return Counter(cell for (cell,) in server.query("SELECT cell FROM participant"))


def test_cells_fill_evenly_up_to_their_quota(set_dir: Path, tmp_path: Path) -> None:
    study = write_study(tmp_path, BETWEEN)
    with Server(study, set_dir, tmp_path / "q.db") as server:
        for num in range(4):
            assert enrol(server).status_code == 201
            assert max(cells(server).values()) - min(cells(server).values()) <= 1 or num == 0
        assert cells(server) == {"drop": 2, "stack": 2}
        full = enrol(server)
        assert full.status_code == 403 and error_code(full) == "study_full"
        with server.client() as client:
            assert client.get("/api/study").json()["state"] == "full"


def test_an_abandoned_list_is_given_to_the_next(set_dir: Path, tmp_path: Path) -> None:
    study = write_study(tmp_path, BETWEEN)
    with Server(study, set_dir, tmp_path / "r.db") as server:
        people = [Person.ready(server) for _ in range(4)]
        people[1].finish()
        with sqlite3.connect(tmp_path / "r.db") as db:
            db.execute("UPDATE session SET last_seen_utc = '2020-01-01T00:00:00.000Z'")
        lists = "SELECT cell, list_no, seed FROM assignment JOIN participant USING (participant_id)"
        lists += " WHERE participant_id = ?"
        new = Person.arrive(server)
        first = server.query(lists, people[0].participant_id)
        assert server.query(lists, new.participant_id) == first  # the same order once more
        # The one who comes back after all can finish; nothing of theirs is lost.
        assert people[0].finish()["step"] == "thanks"
        # A list that was finished is not given away.
        finished = server.query(lists, people[1].participant_id)
        later = [server.query(lists, Person.arrive(server).participant_id) for _ in range(2)]
        assert finished not in later


def test_a_link_is_good_for_its_uses(set_dir: Path, tmp_path: Path) -> None:
    study = write_study(tmp_path, STUDY + "links: required\n")
    db = tmp_path / "l.db"
    with at_work_on(study, set_dir, db) as connection:
        single = make_links(connection, 2, "person", "lab", 1)
        many = make_links(connection, 1, "class", "link", None)[0]
        closed = make_links(connection, 1, "old", "link", 1)[0]
        assert close_links(connection, "old") == 1
        with pytest.raises(StudyError, match="no link has the label"):
            close_links(connection, "nobody")
    assert single[0].address("https://lab.org/") == f"https://lab.org/?link={single[0].token}"
    with Server(study, set_dir, db) as server:
        for link, code in (
            (None, "link_needed"),
            ("guess" * 8, "link_unknown"),
            (closed.token, "link_closed"),
        ):
            reply = enrol(server, link=link, source=None)
            assert reply.status_code == 403 and error_code(reply) == code
        assert enrol(server, link=single[0].token, source=None).status_code == 201
        assert error_code(enrol(server, link=single[0].token)) == "link_used"
        assert enrol(server, link=single[1].token).status_code == 201
        assert [enrol(server, link=many.token).status_code for _ in range(3)] == [201] * 3
        stored = b"".join(path.read_bytes() for path in tmp_path.glob("l.db*"))
        assert single[0].token.encode() not in stored
        sources = server.query("SELECT source, invitation_id FROM participant ORDER BY rowid")
        assert sources == [("lab", 1), ("lab", 2), ("link", 3), ("link", 3), ("link", 3)]


def test_outside_ids_live_in_one_table_and_nobody_takes_part_twice(
    set_dir: Path, study_path: Path, tmp_path: Path
) -> None:
    from verisim.study.server.erasure import erase_participant, forget_outside_ids

    who = {"platform": "prolific", "participant": "5f0ABC_secret", "study": "s1", "session": "x9"}
    other = {**who, "participant": "another_one", "platform": "mturk"}
    db = tmp_path / "o.db"
    with Server(study_path, set_dir, db) as server:
        first = enrol(server, external=who, source=None)
        assert first.status_code == 201
        twice = enrol(server, external=who)
        assert twice.status_code == 403 and error_code(twice) == "already_taken_part"
        assert enrol(server, external=other).status_code == 201
        assert enrol(server, external={**who, "participant": "a b"}).status_code == 422
        assert sorted(server.query("SELECT source FROM participant")) == [
            ("mturk",),
            ("prolific",),
        ]
    with sqlite3.connect(db) as connection:
        tables = connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
        holding = {
            name
            for (name,) in tables.fetchall()
            for row in connection.execute(f"SELECT * FROM {name}")
            if "5f0ABC_secret" in str(row)
        }
    assert holding == {"participant_link"}
    assert erase_participant(db, "5f0ABC_secret", "asked for") == 0
    assert forget_outside_ids(db) == 1
    raw = b"".join(path.read_bytes() for path in tmp_path.glob("o.db*"))
    assert b"5f0ABC_secret" not in raw and b"another_one" not in raw


def test_pilot_and_live_data_are_kept_apart(set_dir: Path, tmp_path: Path) -> None:
    from verisim.study.server.freezing import freeze

    study = write_study(tmp_path)
    freeze(study, set_dir)
    with Server(study, set_dir, tmp_path / "pilot.db", mode="pilot") as server:
        Person.ready(server, source="link")
        assert server.query("SELECT source FROM participant") == [("pilot",)]
    with pytest.raises(StudyError, match="pilot and live data are kept apart"):
        open_study(study, set_dir, tmp_path / "pilot.db", "live")
    with Server(study, set_dir, tmp_path / "live.db", mode="live") as server:
        assert error_code(enrol(server, source="pilot")) == "no_pilot_here"
        assert enrol(server, source="link").status_code == 201


def test_a_paused_study_lets_people_finish_and_nobody_in(
    set_dir: Path, study_path: Path, tmp_path: Path
) -> None:
    with Server(study_path, set_dir, tmp_path / "p.db") as server:
        person = Person.ready(server)
        for state in ("paused", "closed"):
            with sqlite3.connect(tmp_path / "p.db") as db:
                db.execute("UPDATE study SET state = ?", (state,))
            assert error_code(enrol(server)) == f"study_{state}"
            assert person.answer_next().status_code == 201
        assert person.finish()["step"] == "thanks"
