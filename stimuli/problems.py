# SPDX-License-Identifier: MIT
"""What is wrong with a stimulus set, said so that its author can mend it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    """One broken rule of a file."""

    where: str  # FILE:LINE, or FILE alone
    key: str  # path of the key inside the file, e.g. factors.stiffness.levels
    seen: str
    allowed: str
    hint: str = ""

    def __str__(self) -> str:
        text = f"{self.where}: {self.key}" if self.key else self.where
        text += f": saw {shorten(self.seen)}" if self.seen else ""
        text += f"; allowed: {self.allowed}" if self.allowed else ""
        return text + (f"\n  hint: {self.hint}" if self.hint else "")


def shorten(text: str, limit: int = 80) -> str:
    """The text itself, or its start, so that one long value does not bury the message."""
    return text if len(text) <= limit else text[:limit] + "…"


class SetError(ValueError):
    """A stimulus set that breaks the rules; `problems` holds every one of them."""

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.problems = list(problems)
        super().__init__("\n".join(map(str, self.problems)))


class StimuliError(RuntimeError):
    """The set is sound but the work failed; the message ends in a hint."""
