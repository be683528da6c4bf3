# SPDX-License-Identifier: MIT
"""Opens a study database: the settings that make an answer durable, the lock, and migrations."""

from __future__ import annotations

import fcntl
import os
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import Any

from alembic import command
from alembic.config import Config
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, Engine, NullPool, QueuePool, Table, create_engine, event
from sqlalchemy.dialects.postgresql import insert as pg_insert
from sqlalchemy.dialects.sqlite import insert as sqlite_insert

from verisim.study.problems import refuse
from verisim.study.server.postgres import (
    PostgresUrl,
    check_reachable,
    postgres_reading_engine,
    postgres_writing_engine,
    read_url,
)

APPLICATION_ID = 0x56455249  # "VERI" in the file's header: no other SQLite file is taken for ours
BUSY_TIMEOUT_MS = 5000
MIGRATIONS = Path(__file__).parent / "migrations"


# A SQLite file, or a database on a PostgreSQL server.
Place = Path | PostgresUrl


def read_place(text: str) -> Place:
    """Takes a --db from the command line: an address with :// is PostgreSQL's, else a file."""
    return read_url(text) if "://" in text else Path(text)


def utc_now() -> str:
    """Returns the time as ISO 8601 in UTC with milliseconds."""
    return datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")


@contextmanager
def lock_of(db: Place) -> Iterator[None]:
    """Keeps a second server away from a SQLite file; PostgreSQL admits several."""
    if isinstance(db, PostgresUrl):
        yield
        return
    with DatabaseLock(db):
        yield


class DatabaseLock:
    """Holds FILE.lock while a server uses FILE: two writers would starve each other."""

    def __init__(self, db: Path) -> None:
        self.path = db.with_name(db.name + ".lock")
        try:
            self._file = self.path.open("a+", encoding="utf-8")
        except OSError as error:
            raise refuse(
                self.path, f"cannot be written: {error.strerror}", "give --db in a writable folder"
            ) from error
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            self._file.seek(0)
            holder = self._file.read().strip() or "unknown"
            self._file.close()
            raise refuse(
                db,
                f"is in use by another server (process {holder})",
                "stop that server, or give another --db FILE",
            ) from error
        self._file.truncate(0)
        self._file.write(f"{os.getpid()}\n")
        self._file.flush()

    def release(self) -> None:
        self._file.close()  # the lock goes with the file; the file stays, removing it would race

    def __enter__(self) -> DatabaseLock:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.release()


def writing_engine(db: Place, *, foreign_keys: bool = True) -> Engine:
    """Returns the engine of the one writer: durable commits, transactions begun as writes."""
    if isinstance(db, PostgresUrl):
        return postgres_writing_engine(db)
    engine = create_engine(
        "sqlite://",
        creator=lambda: sqlite3.connect(db, check_same_thread=False),
        poolclass=NullPool,
    )

    @event.listens_for(engine, "connect")
    def configure(connection: sqlite3.Connection, _record: Any) -> None:
        # The driver's own transaction handling would begin too late; we begin ourselves.
        connection.isolation_level = None
        journal = connection.execute("PRAGMA journal_mode=WAL").fetchone()[0]
        connection.execute("PRAGMA synchronous=FULL")
        connection.execute(f"PRAGMA foreign_keys={'ON' if foreign_keys else 'OFF'}")
        connection.execute("PRAGMA secure_delete=ON")
        connection.execute(f"PRAGMA busy_timeout={BUSY_TIMEOUT_MS}")
        level = connection.execute("PRAGMA synchronous").fetchone()[0]
        if journal != "wal" or level < 2:
            raise refuse(
                db,
                f"cannot be written durably here (journal {journal}, synchronous {level})",
                "put the database on a local disk",
            )

    @event.listens_for(engine, "begin")
    def begin(connection: Connection) -> None:
        connection.exec_driver_sql("BEGIN IMMEDIATE")

    return engine


def reading_engine(db: Place) -> Engine:
    """Returns an engine whose connections cannot write and never create the file."""
    if isinstance(db, PostgresUrl):
        return postgres_reading_engine(db)
    address = f"{db.resolve().as_uri()}?mode=rw"
    engine = create_engine(
        "sqlite://",
        creator=lambda: sqlite3.connect(address, uri=True, check_same_thread=False),
        poolclass=QueuePool,
        pool_size=8,
        max_overflow=32,
        pool_timeout=5,
    )

    @event.listens_for(engine, "connect")
    def configure(connection: sqlite3.Connection, _record: Any) -> None:
        connection.isolation_level = None
        connection.execute(f"PRAGMA busy_timeout={BUSY_TIMEOUT_MS}")
        connection.execute("PRAGMA query_only=ON")

    @event.listens_for(engine, "begin")
    def begin(connection: Connection) -> None:
        connection.exec_driver_sql("BEGIN")

    return engine


def prepare_database(db: Place) -> None:
    """Creates the file if it is missing and brings its tables to the newest form."""
    check_is_ours(db, may_be_missing=True)
    if isinstance(db, Path):
        db.parent.mkdir(parents=True, exist_ok=True)
    # A migration may write a table anew; with references checked, dropping the old one would erase
    # what refers to it.
    engine = writing_engine(db, foreign_keys=False)
    try:
        with engine.begin() as connection:
            refuse_newer(connection, db)
            config = Config()
            config.set_main_option("script_location", str(MIGRATIONS))
            config.attributes["connection"] = connection
            command.upgrade(config, "head")
            if isinstance(db, PostgresUrl):
                return
            if connection.exec_driver_sql("PRAGMA foreign_key_check").first() is not None:
                raise refuse(db, "has rows that refer to nothing", "bring back the last backup")
            connection.exec_driver_sql(f"PRAGMA application_id={APPLICATION_ID}")
    finally:
        engine.dispose()


def check_is_ours(db: Place, *, may_be_missing: bool = False) -> None:
    """Refuses a missing file and a file that is not a study database."""
    if isinstance(db, PostgresUrl):
        check_reachable(db)
        return
    if not db.exists():
        if may_be_missing:
            return
        raise refuse(db, "no such file", "give the --db FILE that the study was served with")
    try:
        connection = sqlite3.connect(f"{db.resolve().as_uri()}?mode=ro", uri=True)
        try:
            seen = connection.execute("PRAGMA application_id").fetchone()[0]
            empty = connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0] == 0
        finally:
            connection.close()
    except sqlite3.DatabaseError as error:
        raise refuse(db, f"is not a SQLite database: {error}", "give another --db FILE") from error
    if seen != APPLICATION_ID and not (empty and may_be_missing):
        raise refuse(db, "is not a Verisim study database", "give another --db FILE")


def head_revision() -> str:
    head = ScriptDirectory(str(MIGRATIONS)).get_current_head()
    assert head is not None
    return head


def current_revision(connection: Connection) -> str | None:
    return MigrationContext.configure(connection).get_current_revision()


def refuse_newer(connection: Connection, db: Place) -> None:
    """Refuses a database that a later program wrote."""
    seen = current_revision(connection)
    scripts = ScriptDirectory(str(MIGRATIONS))
    if seen is not None and seen not in {script.revision for script in scripts.walk_revisions()}:
        raise refuse(db, f"has tables of a newer program ({seen})", "update Verisim")


def insert_for(connection: Connection, table: Table) -> Any:
    """Returns an INSERT of this database that knows `on_conflict_do_nothing` and `…_update`."""
    return (sqlite_insert if connection.dialect.name == "sqlite" else pg_insert)(table)


def checkpoint(db: Place) -> None:
    """Moves the write-ahead log into the file, so that nothing deleted lingers in the log.

    PostgreSQL keeps its own log and reuses it; what its archive holds is the operator's to expire.
    """
    if isinstance(db, PostgresUrl):
        return
    connection = sqlite3.connect(db)
    try:
        connection.execute(f"PRAGMA busy_timeout={BUSY_TIMEOUT_MS}")
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    finally:
        connection.close()
