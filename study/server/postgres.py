# SPDX-License-Identifier: MIT
"""A study database on PostgreSQL: for several server processes, where SQLite admits one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sqlalchemy import Connection, Engine, NullPool, create_engine, event, make_url
from sqlalchemy.exc import ArgumentError, DBAPIError

from verisim.study.problems import refuse

# Writers of all processes take turns by this lock, held until the commit: what one transaction has
# read cannot change before it writes, as with SQLite's single writer.
WRITE_LOCK = 0x56455249
CONNECT_TIMEOUT_S = 10
DISK_FULL = "53100"  # SQLSTATE


@dataclass(frozen=True)
class PostgresUrl:
    """Where the database is, e.g. postgresql://user@host/name; a password may be in ~/.pgpass."""

    url: str

    def __str__(self) -> str:
        return make_url(self.url).render_as_string(hide_password=True)


def read_url(text: str) -> PostgresUrl:
    """Takes the address from the command line. Raises StudyError for anything else."""
    try:
        url = make_url(text)
    except ArgumentError as error:
        raise refuse(text, "is no database address", "e.g. postgresql://user@host/name") from error
    if url.get_backend_name() != "postgresql" or not url.database:
        raise refuse(str(url), "is no PostgreSQL database", "e.g. postgresql://user@host/name")
    return PostgresUrl(url.set(drivername="postgresql+psycopg").render_as_string(False))


def postgres_writing_engine(place: PostgresUrl) -> Engine:
    """Returns the engine of a process's writer: one transaction at a time over all processes."""
    engine = create_engine(
        place.url, poolclass=NullPool, connect_args={"connect_timeout": CONNECT_TIMEOUT_S}
    )

    @event.listens_for(engine, "connect")
    def configure(connection: Any, _record: Any) -> None:
        with connection.cursor() as cursor:
            cursor.execute("SET synchronous_commit TO on")
            cursor.execute("SET lock_timeout TO '8s'")
        connection.commit()

    @event.listens_for(engine, "begin")
    def begin(connection: Connection) -> None:
        connection.exec_driver_sql(f"SELECT pg_advisory_xact_lock({WRITE_LOCK})")

    return engine


def postgres_reading_engine(place: PostgresUrl) -> Engine:
    """Returns an engine that cannot write and sees one moment per transaction."""
    return create_engine(
        place.url,
        pool_size=8,
        max_overflow=32,
        pool_timeout=5,
        pool_pre_ping=True,
        isolation_level="REPEATABLE READ",
        connect_args={
            "connect_timeout": CONNECT_TIMEOUT_S,
            "options": "-c default_transaction_read_only=on",
        },
    )


def check_reachable(place: PostgresUrl) -> None:
    """Raises StudyError where the server does not answer or refuses."""
    engine = postgres_reading_engine(place)
    try:
        with engine.connect() as connection:
            connection.exec_driver_sql("SELECT 1")
    except DBAPIError as error:
        hint = "check address, user and password, and that the database was created"
        raise refuse(str(place), f"cannot be reached: {error.orig}", hint) from error
    finally:
        engine.dispose()


def sql_state(error: DBAPIError) -> str:
    return str(getattr(error.orig, "sqlstate", None) or "")
