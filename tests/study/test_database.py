# SPDX-License-Identifier: MIT
"""The database: migrations match the tables, foreign files are refused, erasure leaves no trace."""

from __future__ import annotations

import shutil
import sqlite3
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import create_engine
from sqlalchemy.schema import CreateTable
from study_tools import STUDY, Person, Server, new_id, response, trial_body, write_study

from verisim.study.problems import StudyError
from verisim.study.server import erase_participant
from verisim.study.server.database import (
    APPLICATION_ID,
    DatabaseLock,
    head_revision,
    prepare_database,
    writing_engine,
)
from verisim.study.server.open_study import open_study
from verisim.study.server.tables import metadata


def table_parts(db: Path) -> dict[str, list[str]]:
    """The words of every definition, sorted: in which order constraints stand means nothing."""
    return {
        # A table that was written anew carries its name in quotes.
        name: sorted(sql.replace(",", " ").replace('"', "").split())
        for name, sql in table_sql(db).items()
    }


def table_sql(db: Path) -> dict[str, str]:
    """The definition of every table, spaces evened out."""
    with sqlite3.connect(db) as connection:
        rows = connection.execute(
            "SELECT name, sql FROM sqlite_master WHERE type IN ('table', 'index') "
            "AND sql IS NOT NULL AND name <> 'alembic_version'"
        )
        return {name: " ".join(sql.split()) for name, sql in rows}


def test_migrating_an_empty_file_gives_the_tables_of_the_code(tmp_path: Path) -> None:
    migrated, created = tmp_path / "migrated.db", tmp_path / "created.db"
    prepare_database(migrated)
    engine = writing_engine(created)
    with engine.begin() as connection:
        metadata.create_all(connection)
    with writing_engine(migrated).connect() as connection:
        assert compare_metadata(MigrationContext.configure(connection), metadata) == []
    in_code = table_parts(created)
    assert len(in_code) > 25
    assert table_parts(migrated) == in_code


def test_every_table_is_strict_and_every_reference_holds(tmp_path: Path) -> None:
    prepare_database(tmp_path / "study.db")
    for name, sql in table_sql(tmp_path / "study.db").items():
        if sql.startswith("CREATE TABLE"):
            assert sql.endswith("STRICT"), name
    # The same tables can be made elsewhere: nothing in them is SQLite's alone.
    dialect = create_engine("sqlite://").dialect
    assert all(str(CreateTable(table).compile(dialect=dialect)) for table in metadata.sorted_tables)


def test_preparing_again_changes_nothing(tmp_path: Path) -> None:
    db = tmp_path / "study.db"
    prepare_database(db)
    before = table_sql(db)
    prepare_database(db)
    assert table_sql(db) == before
    with sqlite3.connect(db) as connection:
        assert connection.execute("SELECT version_num FROM alembic_version").fetchall() == [
            (head_revision(),)
        ]
        assert connection.execute("PRAGMA application_id").fetchone() == (APPLICATION_ID,)


def test_commits_are_durable_and_references_checked(tmp_path: Path) -> None:
    db = tmp_path / "study.db"
    prepare_database(db)
    with writing_engine(db).connect() as connection:
        for pragma, value in (
            ("journal_mode", "wal"),
            ("synchronous", 2),
            ("foreign_keys", 1),
            ("secure_delete", 1),
        ):
            assert connection.exec_driver_sql(f"PRAGMA {pragma}").scalar() == value


def test_a_file_of_another_program_is_refused(tmp_path: Path) -> None:
    db = tmp_path / "other.db"
    with sqlite3.connect(db) as connection:
        connection.execute("CREATE TABLE t (x)")
    with pytest.raises(StudyError, match="not a Verisim study database"):
        prepare_database(db)
    (tmp_path / "text.db").write_text("words " * 1000)
    with pytest.raises(StudyError, match="not a SQLite database"):
        prepare_database(tmp_path / "text.db")


def test_a_database_of_a_newer_program_is_refused(tmp_path: Path) -> None:
    db = tmp_path / "study.db"
    prepare_database(db)
    with sqlite3.connect(db) as connection:
        connection.execute("UPDATE alembic_version SET version_num = '9999'")
    with pytest.raises(StudyError, match="newer program"):
        prepare_database(db)


def test_a_lock_is_held_by_one(tmp_path: Path) -> None:
    db = tmp_path / "study.db"
    with DatabaseLock(db), pytest.raises(StudyError, match="in use by another server"):
        DatabaseLock(db)
    DatabaseLock(db).release()


def test_a_study_may_change_until_somebody_takes_part(
    set_dir: Path, study_path: Path, tmp_path: Path
) -> None:
    db = tmp_path / "study.db"
    open_study(study_path, set_dir, db)
    changed = write_study(tmp_path / "changed", STUDY.replace("How real?", "How true?"))
    open_study(changed, set_dir, db)
    with Server(changed, set_dir, db) as server:
        Person.arrive(server)
    open_study(changed, set_dir, db)
    with pytest.raises(StudyError, match="changed after 1 participants had come"):
        open_study(study_path, set_dir, db)
    other = write_study(tmp_path / "other", STUDY.replace("name: mini", "name: other"))
    with pytest.raises(StudyError, match="holds the study 'mini', not 'other'"):
        open_study(other, set_dir, db)


def test_a_study_must_be_served_with_its_own_set(set_dir: Path, tmp_path: Path) -> None:
    study = write_study(tmp_path, STUDY.replace("set: mini", "set: maxi"))
    with pytest.raises(StudyError, match="shows 'maxi'"):
        open_study(study, set_dir, tmp_path / "study.db")


def test_a_set_that_moved_is_found_again(set_dir: Path, study_path: Path, tmp_path: Path) -> None:
    db = tmp_path / "study.db"
    open_study(study_path, set_dir, db)
    moved = tmp_path / "moved"
    shutil.copytree(set_dir, moved)
    open_study(study_path, moved, db)
    with sqlite3.connect(db) as connection:
        assert connection.execute("SELECT set_dir FROM study").fetchall() == [(str(moved),)]


def test_erasure_leaves_nothing_of_a_participant(
    set_dir: Path, study_path: Path, tmp_path: Path
) -> None:
    db = tmp_path / "study.db"
    secret = "my name is Rumpelstiltskin"
    with Server(study_path, set_dir, db) as server:
        stays, goes = Person.ready(server), Person.ready(server)
        stays.answer_next()
        answers = [response("realism", 2), response("speed", 1), response("fun", 3)]
        answers.append(response("note", None, secret))
        goes.post("trials", **trial_body(goes.trial()["trial_id"], responses=answers))
        event = {"seq": 1, "presentation_id": None, "kind": "k", "t_ms": 1, "detail": None}
        goes.post("events", submission_id=new_id(), events=[event])
    assert secret.encode() in db.read_bytes()
    assert erase_participant(db, goes.participant_id, "asked for it") == 4
    left = b"".join(path.read_bytes() for path in tmp_path.glob("study.db*"))
    assert secret.encode() not in left and goes.participant_id.encode() not in left
    with sqlite3.connect(db) as connection:
        assert connection.execute("PRAGMA foreign_key_check").fetchall() == []
        assert connection.execute("SELECT count(*) FROM response").fetchone() == (3,)
        assert connection.execute("SELECT num_rows, reason FROM erasure").fetchall() == [
            (4, "asked for it")
        ]
        # The list that became free is handed out again.
        free = connection.execute("SELECT list_no FROM list_slot WHERE participant_id IS NULL")
        assert free.fetchall() == [(1,)]
    with pytest.raises(StudyError, match="no participant"):
        erase_participant(db, goes.participant_id, "again")
    with Server(study_path, set_dir, db) as server:
        newcomer = Person.arrive(server)
        assert server.query(
            "SELECT list_no FROM assignment WHERE participant_id = ?", newcomer.participant_id
        ) == [(1,)]
