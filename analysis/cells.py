# SPDX-License-Identifier: MIT
"""Reads one CSV table as text with its line numbers, and checks its header and every cell."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

import pandas as pd

from verisim.analysis.codebook import DESCRIPTION_FILE, Question, Variable
from verisim.analysis.columns import Column, Table
from verisim.analysis.problems import Problem

UTC = re.compile(r"\d{4}-\d{2}-\d{2}T\d{2}:\d{2}:\d{2}(\.\d+)?(Z|\+00:00)")
SHA256 = re.compile(r"[0-9a-f]{64}")
NUMERIC_KINDS = ("integer", "number", "flag")
# A comment is at most a few thousand characters; a cell past this is a broken quote.
MAX_CELL_CHARS = 1_000_000


@dataclass
class RawTable:
    """A table as it stands in the file: text cells, and the line each row starts on."""

    file: str
    header: list[str] = field(default_factory=list)
    rows: list[list[str]] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)

    def column(self, name: str) -> list[str]:
        """Cells of a column, or nothing when the table lacks it."""
        if name not in self.header:
            return []
        index = self.header.index(name)
        return [row[index] for row in self.rows]

    def frame(self, table: Table) -> pd.DataFrame:
        """Typed rows: numbers as float with NaN for missing, everything else as text."""
        frame = pd.DataFrame(self.rows, columns=pd.Index(self.header), dtype=object)
        for name in self.header:
            if table.columns.get(name, Column()).kind in NUMERIC_KINDS:
                frame[name] = pd.to_numeric(frame[name].replace("", None)).astype(float)
        return frame


def read_table(file: str, data: bytes) -> tuple[RawTable, list[Problem]]:
    """Parse strict RFC 4180 text. Rows of the wrong length are reported and left out."""
    table = RawTable(file)
    problems: list[Problem] = []
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        hint = "save it as UTF-8, or export again"
        return table, [Problem(file, line, None, None, "is not UTF-8", "UTF-8", hint)]
    for mark, name in (("\ufeff", "a byte-order mark"), ("\0", "a NUL character")):
        if mark in text:
            hint = "a spreadsheet may have saved it; export again"
            problems.append(Problem(file, None, None, None, f"holds {name}", "plain UTF-8", hint))
            text = text.replace(mark, "")
    if text.split("\n", 1)[0].endswith("\r"):
        hint = "a spreadsheet may have saved it; export again"
        problems.append(Problem(file, 1, None, None, "lines end in CR LF", "LF", hint))
    csv.field_size_limit(MAX_CELL_CHARS)
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    line = 1
    try:
        for row in reader:
            if not table.header:
                table.header = row
            elif len(row) != len(table.header):
                message = f"has {len(row)} cells"
                allowed = f"{len(table.header)} cells, as in the header"
                hint = "a comma or quote is not escaped; export again"
                problems.append(Problem(file, line, None, None, message, allowed, hint))
            else:
                table.rows.append(row)
                table.lines.append(line)
            line = reader.line_num + 1
    except csv.Error as error:
        hint = "a quote is not closed; export again"
        problems.append(Problem(file, line, None, None, f"is not CSV: {error}", "RFC 4180", hint))
    return table, problems


def check_header(raw: RawTable, table: Table, listed: dict[str, Variable]) -> list[Problem]:
    """Required columns are there, once each, and the codebook lists every column."""
    problems = []
    for name in table.columns:
        if name not in raw.header:
            problems.append(
                Problem(raw.file, 1, name, None, "is missing", "", "export again with this version")
            )
    for name in sorted({name for name in raw.header if raw.header.count(name) > 1}):
        hint = "each column stands once; export again"
        problems.append(Problem(raw.file, 1, name, None, "stands twice", "one", hint))
    for name in dict.fromkeys(raw.header):
        if name not in listed:
            hint = "Psych-DS wants every column described; export again"
            allowed = "a column listed in variableMeasured"
            message = f"is not in the codebook ({DESCRIPTION_FILE})"
            problems.append(Problem(raw.file, 1, name, None, message, allowed, hint))
    return problems


def check_cells(
    raw: RawTable, table: Table, listed: dict[str, Variable], scales: dict[str, Question]
) -> list[Problem]:
    """Every cell is of its column's kind and inside the range that column or codebook gives."""
    problems = []
    for name in dict.fromkeys(raw.header):
        column = table.columns.get(name, Column())
        variable = listed.get(name, Variable(name))
        for line, value in zip(raw.lines, raw.column(name), strict=True):
            broken = _broken_rule(value, column, variable)
            if broken is not None:
                message, allowed = broken
                problems.append(
                    Problem(raw.file, line, name, value, message, allowed, _hint(column))
                )
    problems += _answers_off_scale(raw, scales)
    return problems


def _broken_rule(value: str, column: Column, variable: Variable) -> tuple[str, str] | None:
    if value == "":
        return ("is empty", "a value") if column.filled else None
    allowed = column.allowed or variable.levels
    if allowed and value not in allowed and not _same_number_in(value, allowed):
        return "is not an allowed value", ", ".join(allowed)
    if column.kind == "utc":
        return None if UTC.fullmatch(value) else ("is not a UTC time", "2026-01-31T12:00:00Z")
    if column.kind == "sha256":
        return None if SHA256.fullmatch(value) else ("is not a sha256", "64 hex digits")
    if column.kind == "flag":
        return None if value in ("0", "1") else ("is not a flag", "0 or 1")
    if column.kind == "text":
        return None
    return _broken_number(value, column, variable)


def _broken_number(value: str, column: Column, variable: Variable) -> tuple[str, str] | None:
    number = parse_number(value)
    if number is None:
        return "is not a number", "a finite number with a decimal point"
    if column.kind == "integer" and not number.is_integer():
        return "is not a whole number", "a whole number"
    lows = [low for low in (column.minimum, variable.minimum) if low is not None]
    if lows and number < max(lows):
        return "is too small", f"at least {max(lows):g}"
    if variable.maximum is not None and number > variable.maximum:
        return "is too large", f"at most {variable.maximum:g}"
    return None


def _answers_off_scale(raw: RawTable, scales: dict[str, Question]) -> Iterator[Problem]:
    """Answers outside the scale of the question they answer."""
    rows = zip(raw.lines, raw.column("question"), raw.column("value"), strict=False)
    for line, key, value in rows:
        scale, number = scales.get(key), parse_number(value)
        if scale is None or number is None or scale.minimum is None or scale.maximum is None:
            continue
        whole = scale.kind not in ("rating", "bipolar") or number.is_integer()
        if not (scale.minimum <= number <= scale.maximum and whole):
            allowed = f"{scale.minimum:g} to {scale.maximum:g}"
            allowed += " in whole numbers" if scale.kind in ("rating", "bipolar") else ""
            message = f"is off the scale of question {key}"
            hint = "the answer and the study file disagree; check which version was served"
            yield Problem(raw.file, line, "value", value, message, allowed, hint)


def parse_number(value: str) -> float | None:
    """A finite number in plain notation, else None (nan, inf, 1_000 and blanks are refused)."""
    if not re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", value):
        return None
    number = float(value)
    return number if math.isfinite(number) else None


def _same_number_in(value: str, allowed: tuple[str, ...]) -> bool:
    number = parse_number(value)
    return number is not None and any(parse_number(level) == number for level in allowed)


def _hint(column: Column) -> str:
    if column.filled:
        return "this cell is needed; export again, or check the version that wrote it"
    return "leave a missing value empty; otherwise export again"
