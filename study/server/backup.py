# SPDX-License-Identifier: MIT
"""Copies a study database while it is in use, checks that it is whole, lets old copies expire."""

from __future__ import annotations

import os
import sqlite3
from datetime import UTC, datetime, timedelta
from pathlib import Path

from verisim.study.problems import StudyError, refuse
from verisim.study.server.database import check_is_ours

PAGES_AT_ONCE = 500  # the writer gets its turn between two helpings


def back_up(db: Path, folder: Path, keep_days: int | None = None) -> Path:
    """Copies one moment of the database into `folder` and returns the copy, checked.

    Runs beside a server. keep_days: older copies of the same database are deleted, so that erased
    participants do not live on in them.
    """
    check_is_ours(db)
    folder.mkdir(parents=True, exist_ok=True)
    stamp = datetime.now(UTC).strftime("%Y%m%dT%H%M%S%fZ")
    target = folder / f"{db.stem}.{stamp}.db"
    unfinished = target.with_suffix(".part")
    try:
        source = sqlite3.connect(f"{db.resolve().as_uri()}?mode=ro", uri=True)
        copy = sqlite3.connect(unfinished)
        try:
            source.backup(copy, pages=PAGES_AT_ONCE, sleep=0.01)
            copy.execute("PRAGMA journal_mode=DELETE")
        finally:
            copy.close()
            source.close()
        problems = find_damage(unfinished)
        if problems:
            raise refuse(db, f"the copy is damaged: {problems[0]}", "check the disk, try again")
        with unfinished.open("rb") as file:
            os.fsync(file.fileno())
        unfinished.rename(target)
    except (sqlite3.Error, OSError) as error:
        raise refuse(target, f"cannot be written: {error}", "check space and rights") from error
    finally:
        unfinished.unlink(missing_ok=True)
    if keep_days is not None:
        expire(folder, db.stem, keep_days)
    return target


def expire(folder: Path, stem: str, keep_days: int) -> list[Path]:
    """Deletes copies older than so many days; returns which."""
    oldest = datetime.now(UTC) - timedelta(days=keep_days)
    gone: list[Path] = []
    for copy in sorted(folder.glob(f"{stem}.*.db")):
        if datetime.fromtimestamp(copy.stat().st_mtime, UTC) < oldest:
            copy.unlink()
            gone.append(copy)
    return gone


def find_damage(db: Path) -> list[str]:
    """Returns what is wrong inside a database file: broken pages, rows that lead nowhere."""
    try:
        check_is_ours(db)
    except StudyError as error:
        if isinstance(error.__cause__, sqlite3.DatabaseError):
            return [str(error.__cause__)]
        raise
    connection = sqlite3.connect(f"{db.resolve().as_uri()}?mode=ro", uri=True)
    try:
        faults = [row[0] for row in connection.execute("PRAGMA integrity_check(20)")]
        problems = [fault for fault in faults if fault != "ok"]
        for table, row, parent, _ in connection.execute("PRAGMA foreign_key_check"):
            problems.append(f"{table} row {row} leads to no {parent}")
    except sqlite3.DatabaseError as error:
        return [str(error)]
    finally:
        connection.close()
    return problems
