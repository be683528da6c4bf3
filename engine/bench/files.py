# SPDX-License-Identifier: MIT
"""Tables that survive a kill, files that appear whole, and one bench a folder."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from verisim.bench.problems import BenchError
from verisim.stimuli.only_writer import only_writer


def table_text(columns: Sequence[str], rows: Iterable[dict[str, Any]]) -> str:
    buffer = io.StringIO()
    writer = csv.DictWriter(buffer, columns, lineterminator="\n", extrasaction="ignore")
    writer.writeheader()
    for row in rows:
        writer.writerow({key: "" if value is None else value for key, value in row.items()})
    return buffer.getvalue()


def write_whole(file: Path, content: str | bytes) -> None:
    """The file appears complete or not at all."""
    part = file.with_name(f".{file.name}.part")
    data = content.encode() if isinstance(content, str) else content
    with part.open("wb") as stream:
        stream.write(data)
        stream.flush()
        os.fsync(stream.fileno())
    part.replace(file)


def append_row(file: Path, columns: Sequence[str], row: dict[str, Any]) -> None:
    """One more row at the end of a table that `whole_rows` reads."""
    text = table_text(columns, [row]).split("\n", 1)[1]
    with file.open("a", encoding="utf-8", newline="") as stream:
        stream.write(text)


def whole_rows(file: Path, columns: Sequence[str]) -> list[dict[str, str]]:
    """The rows of a table, less one that a kill cut off; none if its columns are other ones."""
    if not file.is_file():
        return []
    text = file.read_text("utf-8")
    text = text[: text.rfind("\n") + 1]  # a row that was cut off has no end of line
    reader = csv.DictReader(io.StringIO(text))
    if tuple(reader.fieldnames or ()) != tuple(columns):
        return []
    return [row for row in reader if row[columns[-1]] is not None]


@contextmanager
def only_bench(directory: Path) -> Iterator[None]:
    """Makes the directory and keeps other benches out of it."""
    if directory.exists() and not directory.is_dir():
        raise BenchError(f"-o: saw {directory}, a file\n  hint: name a folder")
    directory.mkdir(parents=True, exist_ok=True)
    with only_writer(directory, "bench", BenchError):
        yield
