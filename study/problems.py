# SPDX-License-Identifier: MIT
"""What is wrong with a study, its clips or its database, said so that the reader can act."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong: where, what was seen, what is allowed, and what to do."""

    where: str  # file, file:line, or address
    message: str
    hint: str = ""

    def __str__(self) -> str:
        text = f"{self.where}: {self.message}"
        return f"{text}\n  hint: {self.hint}" if self.hint else text


class StudyError(Exception):
    """A study, stimulus directory or database that cannot be used; holds every problem found."""

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.problems = list(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))


def refuse(where: object, message: str, hint: str = "") -> StudyError:
    """Returns the error for a single problem."""
    return StudyError([Problem(str(where), message, hint)])
