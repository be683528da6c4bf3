# SPDX-License-Identifier: MIT
"""A live study is the frozen one; copies are whole; every released form of the tables migrates."""

from __future__ import annotations

import json
import os
import shutil
import sqlite3
import threading
import time
from pathlib import Path

import pytest
from alembic import command
from alembic.config import Config
from alembic.script import ScriptDirectory
from study_tools import STUDY, Person, Server, write_study

from verisim.study.export import export
from verisim.study.problems import StudyError
from verisim.study.server.backup import back_up, expire, find_damage
from verisim.study.server.database import MIGRATIONS, prepare_database, writing_engine
from verisim.study.server.freezing import freeze, frozen_path
from verisim.study.server.open_study import open_study


def deviations(db: Path) -> list[tuple[str, str]]:
    with sqlite3.connect(db) as connection:
        return connection.execute("SELECT what, outcome FROM deviation").fetchall()


def test_a_live_study_must_be_frozen_and_unchanged(set_dir: Path, tmp_path: Path) -> None:
    study, db = write_study(tmp_path), tmp_path / "live.db"
    protocol = tmp_path / "protocol.md"
    protocol.write_text("We will count.\n")
    with pytest.raises(StudyError, match="the study is not frozen"):
        open_study(study, set_dir, db, "live")
    freeze(study, set_dir, protocol)
    document = json.loads(frozen_path(study).read_text())
    assert set(document["sha256"]) == {
        "study file",
        "study and texts",
        "exclusion rules",
        "manifest",
        "clips",
        "protocol",
    }
    assert len(document["clip_sha256"]) == 8
    open_study(study, set_dir, db, "live")
    assert deviations(db) == []

    protocol.write_text("We will count and look again.\n")
    with pytest.raises(StudyError, match="changed since it was frozen: protocol"):
        open_study(study, set_dir, db, "live")
    write_study(tmp_path, STUDY.replace("missed_catch: 1", "missed_catch: 2"))
    with pytest.raises(StudyError, match="exclusion rules, protocol, study and texts, study file"):
        open_study(study, set_dir, db, "live")
    assert ("protocol", "refused") in deviations(db) and len(deviations(db)) == 5

    with pytest.raises(StudyError, match="is frozen already; changed since"):
        freeze(study, set_dir, protocol)
    freeze(study, set_dir, protocol, reason="a typing error")
    open_study(study, set_dir, db, "live")
    accepted = [what for what, outcome in deviations(db) if outcome == "accepted: a typing error"]
    assert sorted(accepted) == ["exclusion rules", "protocol", "study and texts", "study file"]
    open_study(study, set_dir, db, "live")
    assert len(deviations(db)) == 9  # logged once


def test_changed_texts_count_as_a_change(set_dir: Path, tmp_path: Path) -> None:
    study = write_study(tmp_path)
    freeze(study, set_dir)
    (tmp_path / "consent.md").write_text("# Other\n\nVersion: 4\n")
    with pytest.raises(StudyError, match="changed since it was frozen: study and texts"):
        open_study(study, set_dir, tmp_path / "live.db", "live")


def test_a_copy_is_whole_while_answers_come_in(
    set_dir: Path, study_path: Path, tmp_path: Path
) -> None:
    db = tmp_path / "busy.db"
    with Server(study_path, set_dir, db) as server:
        acknowledged: list[int] = []
        stop = threading.Event()

        def rate() -> None:
            while not stop.is_set():
                person = Person.ready(server)
                while person.next()["step"] == "trial" and not stop.is_set():
                    assert person.answer_next().status_code == 201
                    acknowledged.append(1)

        thread = threading.Thread(target=rate)
        thread.start()
        copies = []
        try:
            for _ in range(4):
                before = len(acknowledged)
                copy = back_up(db, tmp_path / "copies")
                copies.append((before, copy))
                time.sleep(0.2)
        finally:
            stop.set()
            thread.join()
    assert len(acknowledged) >= 2
    for before, copy in copies:
        assert find_damage(copy) == []
        with sqlite3.connect(copy) as connection:
            num = connection.execute(
                "SELECT count(*) FROM trial WHERE answered_utc IS NOT NULL"
            ).fetchone()[0]
        assert num >= before
        export(copy, tmp_path / f"x{copy.stem}")


def test_damage_is_found_and_old_copies_expire(set_dir: Path, tmp_path: Path) -> None:
    db = tmp_path / "study.db"
    open_study(write_study(tmp_path), set_dir, db)
    copy = back_up(db, tmp_path / "copies")
    raw = bytearray(copy.read_bytes())
    for at in range(5 * 4096, len(raw), 4096):
        raw[at : at + 300] = os.urandom(300)
    damaged = tmp_path / "damaged.db"
    damaged.write_bytes(raw)
    assert find_damage(damaged)
    old = tmp_path / "copies" / "study.20200101T000000000000Z.db"
    shutil.copy(copy, old)
    os.utime(old, (0, 0))
    assert expire(tmp_path / "copies", "study", 30) == [old] and copy.exists()


REVISIONS = [s.revision for s in ScriptDirectory(str(MIGRATIONS)).walk_revisions()][::-1]


def old_database(db: Path, revision: str) -> None:
    """A database with a participant's answers as the program of that revision left it."""
    engine = writing_engine(db, foreign_keys=False)
    with engine.begin() as connection:
        config = Config()
        config.set_main_option("script_location", str(MIGRATIONS))
        config.attributes["connection"] = connection
        command.upgrade(config, revision)
        connection.exec_driver_sql("PRAGMA application_id=1447383625")
    engine.dispose()


@pytest.mark.parametrize("revision", REVISIONS)
def test_every_released_form_migrates_with_its_data(
    set_dir: Path, study_path: Path, tmp_path: Path, revision: str
) -> None:
    # Data of today, carried back into the old tables column by column, then migrated.
    with Server(study_path, set_dir, tmp_path / "new.db") as server:
        Person.ready(server).finish()
        Person.ready(server).answer_next()
    old = tmp_path / "old.db"
    old_database(old, revision)
    with sqlite3.connect(old) as connection:
        connection.execute("ATTACH ? AS new", (str(tmp_path / "new.db"),))
        triggers = connection.execute(
            "SELECT name, sql FROM main.sqlite_master WHERE type = 'trigger'"
        ).fetchall()
        names = connection.execute(
            "SELECT name FROM main.sqlite_master WHERE type = 'table' AND name <> 'alembic_version'"
        ).fetchall()
        for (name,) in names:
            info = connection.execute(f"PRAGMA main.table_info({name})")
            columns = ", ".join(row[1] for row in info)
            connection.execute(
                f"INSERT INTO main.{name} ({columns}) SELECT {columns} FROM new.{name}"
            )
    assert len(triggers) == 4
    prepare_database(old)
    counts = []
    for db in (old, tmp_path / "new.db"):
        with sqlite3.connect(db) as connection:
            tables = [
                name
                for (name,) in connection.execute(
                    "SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name"
                )
            ]
            counts.append({t: connection.execute(f"SELECT count(*) FROM {t}").fetchone()
                           for t in tables})  # fmt: skip
    assert counts[0] == counts[1]
    assert find_damage(old) == []
    export(old, tmp_path / "x-old")
    export(tmp_path / "new.db", tmp_path / "x-new")
    for path in sorted((tmp_path / "x-new").rglob("*.csv")):
        same = tmp_path / "x-old" / path.relative_to(tmp_path / "x-new")
        if revision == REVISIONS[0] and "table-participants" in path.name:
            continue  # which side the buttons were on is known from the second form on
        assert same.read_bytes() == path.read_bytes(), path.name
    with sqlite3.connect(old) as connection, pytest.raises(sqlite3.IntegrityError):
        connection.execute("UPDATE response SET value = 1")
