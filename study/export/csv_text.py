# SPDX-License-Identifier: MIT
"""Writes tables as CSV that reads the same everywhere: comma, LF, RFC 4180, empty = missing."""

from __future__ import annotations

import csv
import io
from typing import Any

FORMULA_STARTS = ("=", "+", "-", "@", "\t", "\r")


def to_csv(columns: list[str], rows: list[dict[str, Any]]) -> str:
    """Returns the table's text. A row may hold more than the columns; a missing cell is empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        writer.writerow([to_cell(row.get(column)) for column in columns])
    return text.getvalue()


def to_cell(value: Any) -> str:
    """Returns a cell: whole numbers without a point, other numbers in full, text made harmless."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, float):
        return str(int(value)) if value.is_integer() and abs(value) < 2**53 else repr(value)
    if isinstance(value, str):
        return defuse(value)
    return str(value)


def defuse(text: str) -> str:
    """Keeps spreadsheet programs from running a text as a formula: an apostrophe goes before it."""
    return f"'{text}" if text.startswith(FORMULA_STARTS) else text
