# SPDX-License-Identifier: MIT
"""Changes from the command line: one transaction on a study's database, no server beside it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy import Connection, select

from verisim.study.server import tables
from verisim.study.server.database import (
    Place,
    lock_of,
    prepare_database,
    writing_engine,
)
from verisim.study.server.open_study import open_study


@contextmanager
def at_work_on(study: Path, set_dir: Path, db: Place) -> Iterator[Connection]:
    """Yields a connection whose work is committed at the end; the study is opened if it is new.

    Raises StudyError while a server uses the file.
    """
    if isinstance(db, Path):
        db.parent.mkdir(parents=True, exist_ok=True)
    with lock_of(db):
        prepare_database(db)
        engine = writing_engine(db)
        try:
            with engine.begin() as connection:
                is_new = connection.scalar(select(tables.study.c.study_id)) is None
            if is_new:
                open_study(study, set_dir, db)
            with engine.begin() as connection:
                yield connection
        finally:
            engine.dispose()
