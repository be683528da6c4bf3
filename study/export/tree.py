# SPDX-License-Identifier: MIT
"""Writes the export into a new directory, which takes its name only when it is complete."""

from __future__ import annotations

import hashlib
import os
import shutil
from collections import Counter
from pathlib import Path
from typing import Any

from sqlalchemy import Connection

from verisim.study.export import rows
from verisim.study.export.blinding import Blinding
from verisim.study.export.csv_text import to_csv
from verisim.study.export.documents import dataset_description, file_name, readme
from verisim.study.export.engine_rows import engine
from verisim.study.export.exclusions import exclusions
from verisim.study.export.layout import TABLES, column_names
from verisim.study.problems import refuse
from verisim.study.server.database import (
    Place,
    check_is_ours,
    current_revision,
    head_revision,
    reading_engine,
)

DESCRIPTION = "dataset_description.json"
Tables = dict[str, list[dict[str, Any]]]


def export(db: Place, out_dir: Path, *, blind: bool = False, force: bool = False) -> dict[str, int]:
    """Writes the export tree and returns the number of rows per table.

    Reads one moment of the database, also while a server writes to it. The same content gives the
    same bytes. blind: clips, methods and levels become codes. force: replaces an earlier export.
    Raises StudyError for a missing or foreign database and for an out_dir that is in the way.
    """
    check_is_ours(db)
    check_target(out_dir, force)
    reader = reading_engine(db)
    try:
        with reader.begin() as connection:
            files, counts = render(connection, db, blind)
    finally:
        reader.dispose()
    write_tree(out_dir, files)
    return counts


def check_target(out_dir: Path, force: bool) -> None:
    """Refuses a directory that holds anything but an earlier export, and that without force."""
    if not out_dir.exists() or (out_dir.is_dir() and not any(out_dir.iterdir())):
        return
    if not out_dir.is_dir() or not (out_dir / DESCRIPTION).is_file():
        raise refuse(out_dir, "is there already and is no export", "give another -o DIR")
    if not force:
        raise refuse(out_dir, "holds an export already", "give another -o DIR, or add --force")


def render(connection: Connection, db: Place, blind: bool) -> tuple[dict[str, str], dict[str, int]]:
    """Returns the content of every file by path, and the number of rows per table."""
    if current_revision(connection) != head_revision():
        raise refuse(
            db,
            "has tables of another version of the program",
            "serve it once with this version, which brings it up to date",
        )
    snapshot = rows.take_snapshot(connection)
    if snapshot is None:
        raise refuse(db, "holds no study yet", "serve a study with this --db first")
    tables = read_tables(snapshot)
    sources = Counter(person["source"] for person in tables["participants"])
    num_people = dict(sorted(sources.items()))
    if blind:
        blinding = Blinding(snapshot.study["blind_key"])
        tables = {name: blinding.hide(name, content) for name, content in tables.items()}
        for name in ("stimuli", "engine"):  # the order would give the names away
            tables[name].sort(key=lambda row: str(row["stimulus"]))
    questions = rows.questions(snapshot)
    files = {
        file_name(snapshot.name, name): to_csv(column_names(name, snapshot.factor_names), content)
        for name, content in tables.items()
    }
    files[DESCRIPTION] = dataset_description(snapshot, questions, num_people, blind=blind)
    files["README.md"] = readme(snapshot, questions, num_people, blind=blind)
    files["sha256.txt"] = "".join(
        f"{hashlib.sha256(text.encode()).hexdigest()}  {path}\n"
        for path, text in sorted(files.items())
    )
    return files, {name: len(content) for name, content in tables.items()}


def read_tables(snapshot: rows.Snapshot) -> Tables:
    people, ratings = rows.participants(snapshot), rows.ratings(snapshot)
    shown = rows.presentations(snapshot)
    end_answers, end_comments = rows.end_answers(snapshot)
    tables: Tables = {
        "ratings": ratings,
        "participants": people,
        "sessions": rows.sessions(snapshot),
        "presentations": shown,
        "showings": rows.shown_clips(snapshot),
        "closing": end_answers,
        "remarks": end_comments,
        "stimuli": rows.stimuli(snapshot),
        "engine": engine(snapshot),
        "events": rows.events(snapshot),
        "exclusions": exclusions(snapshot, people, ratings, shown),
        "comments": rows.comments(snapshot),
    }
    assert tables.keys() == TABLES.keys()
    study = {"study": snapshot.name}
    return {name: [{**row, **study} for row in content] for name, content in tables.items()}


def write_tree(out_dir: Path, files: dict[str, str]) -> None:
    """Writes beside the target and renames, so that a half-written export never bears its name."""
    out_dir.parent.mkdir(parents=True, exist_ok=True)
    fresh = out_dir.with_name(f".{out_dir.name}.{os.getpid()}.new")
    shutil.rmtree(fresh, ignore_errors=True)
    try:
        for path, text in files.items():
            file = fresh / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8", newline="")
        if out_dir.exists():
            old = out_dir.with_name(f".{out_dir.name}.{os.getpid()}.old")
            out_dir.rename(old)
            fresh.rename(out_dir)
            shutil.rmtree(old)
        else:
            fresh.rename(out_dir)
    except OSError as error:
        raise refuse(
            out_dir, f"cannot be written: {error.strerror}", "check space and rights, try again"
        ) from error
    finally:
        shutil.rmtree(fresh, ignore_errors=True)
