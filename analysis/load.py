# SPDX-License-Identifier: MIT
"""Reads an export tree and checks all of it: names, checksums, columns, cells, links."""

from __future__ import annotations

import hashlib
import json
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pandas as pd

from verisim.analysis import codebook
from verisim.analysis.cells import RawTable, check_cells, check_header, read_table
from verisim.analysis.codebook import DESCRIPTION_FILE, Question
from verisim.analysis.columns import TABLES
from verisim.analysis.links import check_links
from verisim.analysis.problems import ExportError, Problem

CHECKSUM_FILE = "sha256.txt"
# Psych-DS: key-value pairs joined by _, then the suffix _data. A study's own name may hold _.
FILE_NAME = re.compile(r"study-(?P<study>[A-Za-z0-9]\w*?)_table-(?P<table>[a-z]+)_data\.csv")
CHECKSUM_LINE = re.compile(r"(?P<sha>[0-9a-f]{64}) [ *](?P<path>.+)")


@dataclass
class Export:
    """A checked export. tables: name -> rows; numbers are float (missing = NaN), text is str."""

    study: str
    description: dict[str, Any]
    tables: dict[str, pd.DataFrame]
    questions: dict[str, Question]
    sha256: dict[str, str]  # file (relative to the tree) -> sha256 of its bytes


@dataclass
class _Tree:
    root: Path
    description: dict[str, Any] = field(default_factory=dict)
    raw: dict[str, RawTable] = field(default_factory=dict)
    studies: set[str] = field(default_factory=set)
    sha256: dict[str, str] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)


def check_export(path: Path | str) -> list[Problem]:
    """Everything wrong with the export tree at `path`; empty when it is sound."""
    return _read(Path(path)).problems


def load_export(path: Path | str) -> Export:
    """The export at `path`. Raises ExportError with every problem when it breaks a rule."""
    tree = _read(Path(path))
    if tree.problems:
        raise ExportError(tree.problems)
    tables = {name: raw.frame(TABLES[name]) for name, raw in tree.raw.items()}
    return Export(
        study=min(tree.studies),
        description=tree.description,
        tables=tables,
        questions=_questions_asked(tables["ratings"], codebook.questions(tree.description)),
        sha256=dict(sorted(tree.sha256.items())),
    )


def _read(root: Path) -> _Tree:
    tree = _Tree(root)
    if not root.is_dir():
        tree.problems.append(
            _file_problem(str(root), "no such folder", "an export tree", "run `verisim export`")
        )
        return tree
    _read_description(tree)
    _read_tables(tree)
    _check_checksums(tree)
    listed = codebook.variables(tree.description)
    scales = codebook.questions(tree.description)
    for name, raw in tree.raw.items():
        tree.problems += check_header(raw, TABLES[name], listed)
        tree.problems += check_cells(raw, TABLES[name], listed, scales)
    tree.problems += check_links(tree.raw)
    return tree


def _read_description(tree: _Tree) -> None:
    data = _bytes_of(tree, tree.root / DESCRIPTION_FILE)
    if data is None:
        return
    try:
        description = json.loads(data.decode("utf-8"))
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        tree.problems.append(
            _file_problem(DESCRIPTION_FILE, f"is not JSON: {error}", "UTF-8 JSON", "export again")
        )
        return
    tree.problems += codebook.check_description(description)
    if isinstance(description, dict):
        tree.description = description


def _read_tables(tree: _Tree) -> None:
    folder = tree.root / "data"
    if not folder.is_dir():
        tree.problems.append(
            _file_problem("data/", "is missing", "a folder data", "Psych-DS keeps tables there")
        )
        return
    for path in sorted(folder.glob("*.csv")):
        name = f"data/{path.name}"
        match = FILE_NAME.fullmatch(path.name)
        if match is None or match["table"] not in TABLES:
            tree.problems.append(
                _file_problem(
                    name,
                    "is not the name of an export table",
                    f"study-NAME_table-TABLE_data.csv, TABLE one of {', '.join(sorted(TABLES))}",
                    "keep other files outside data/",
                )
            )
            continue
        if match["table"] in tree.raw:
            tree.problems.append(
                _file_problem(
                    name,
                    f"is a second table {match['table']}",
                    "one file per table",
                    "export each study into its own folder",
                )
            )
            continue
        data = _bytes_of(tree, path)
        if data is not None:
            raw, problems = read_table(name, data)
            tree.problems += problems
            tree.raw[match["table"]] = raw
            tree.studies.add(match["study"])
    for table in sorted(TABLES.keys() - tree.raw.keys()):
        tree.problems.append(
            _file_problem(
                f"data/study-NAME_table-{table}_data.csv",
                "is missing",
                "one file for each table; a table may have no rows",
                "export again; do not delete tables",
            )
        )


def _check_checksums(tree: _Tree) -> None:
    data = _bytes_of(tree, tree.root / CHECKSUM_FILE)
    if data is None:
        return
    listed = set()
    for number, line in enumerate(data.decode("utf-8", "replace").splitlines(), start=1):
        match = CHECKSUM_LINE.fullmatch(line)
        if match is None or ".." in match["path"].split("/") or match["path"].startswith("/"):
            tree.problems.append(
                Problem(
                    CHECKSUM_FILE, number, None, line, "is not a checksum line",
                    "64 hex digits, two spaces, a path inside the tree", "export again",
                )
            )  # fmt: skip
            continue
        path = match["path"].removeprefix("./")
        listed.add(path)
        seen = tree.sha256.get(path) or _sha256_of(tree.root / path)
        if seen is None:
            message, value = f"{path} is listed but missing", None
        elif seen != match["sha"]:
            message, value = f"{path} has changed since the export", seen
        else:
            continue
        tree.problems.append(
            Problem(
                CHECKSUM_FILE, number, None, value, message, match["sha"],
                "export again, or put the original file back; corrections belong in the study",
            )
        )  # fmt: skip
    for path in sorted(tree.sha256.keys() - listed - {CHECKSUM_FILE}):
        tree.problems.append(
            _file_problem(path, f"is not in {CHECKSUM_FILE}", "a line for it", "export again")
        )


def _bytes_of(tree: _Tree, path: Path) -> bytes | None:
    name = path.relative_to(tree.root).as_posix()
    try:
        data = path.read_bytes()
    except OSError as error:
        missing = isinstance(error, FileNotFoundError)
        reason = "is missing" if missing else f"cannot be read: {error}"
        tree.problems.append(_file_problem(name, reason, "a readable file", "export again"))
        return None
    tree.sha256[name] = hashlib.sha256(data).hexdigest()
    return data


def _sha256_of(path: Path) -> str | None:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError:
        return None


def _questions_asked(ratings: pd.DataFrame, known: dict[str, Question]) -> dict[str, Question]:
    """Questions with number answers: in the study's order, then any the codebook leaves out."""
    numeric = ratings[ratings["value"].notna()]
    kinds = dict(zip(numeric["question"], numeric["question_kind"], strict=True))
    ordered = [key for key in known if key in kinds]
    ordered += sorted(kinds.keys() - known.keys())
    return {key: known.get(key, Question(key, kinds[key])) for key in ordered}


def _file_problem(file: str, message: str, allowed: str, hint: str) -> Problem:
    return Problem(file, None, None, None, message, allowed, hint)
