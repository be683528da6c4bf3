# SPDX-License-Identifier: MIT
"""What is wrong with an export, said so that the reader can mend it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    """One broken rule. `row` is the line of the file, 1 = the header; None = the whole file."""

    file: str
    row: int | None
    column: str | None
    value: str | None
    message: str
    allowed: str
    hint: str

    def __str__(self) -> str:
        place = self.file if self.row is None else f"{self.file}:{self.row}"
        column = "" if self.column is None else f" column {self.column}:"
        seen = "" if self.value is None else f" (found {shorten(self.value)!r})"
        allowed = f"\n  allowed: {self.allowed}" if self.allowed else ""
        return f"{place}:{column} {self.message}{seen}{allowed}\n  hint: {self.hint}"


def shorten(value: str, limit: int = 80) -> str:
    """The value itself, or its start, so that one long cell does not bury the message."""
    return value if len(value) <= limit else value[:limit] + "…"


class ExportError(Exception):
    """The export breaks its own rules; `problems` holds every one of them."""

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.problems = list(problems)
        count = len(self.problems)
        head = f"the export has {count} problem{'' if count == 1 else 's'}:"
        super().__init__("\n".join([head, *map(str, self.problems)]))


class AnalysisError(Exception):
    """The export is sound but what was asked cannot be done; the message ends in a hint."""

    def __init__(self, message: str, hint: str) -> None:
        self.hint = hint
        super().__init__(f"{message}\n  hint: {hint}")
