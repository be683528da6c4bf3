# SPDX-License-Identifier: MIT
"""What passes between a question and its answerer: an answer, a scale, what a rater perceived."""

from __future__ import annotations

from typing import NamedTuple


class Scale(NamedTuple):
    """The values a numeric question takes."""

    min: float
    max: float
    step: float


class Answer(NamedTuple):
    """What was answered: a number, a text, or neither (skipped)."""

    value: float | None
    value_text: str | None

    @property
    def is_skipped(self) -> bool:
        return self.value is None and not (self.value_text or "").strip()


class Percept(NamedTuple):
    """What a scripted rater made of a trial, clip by clip in the order shown."""

    qualities: tuple[float, ...]  # as felt, 0 (plainly wrong) to 1 (right)
    noticed: tuple[bool, ...]  # whether the fault was seen
    duration_ms: float
    lean: float = 0.0  # towards the first (negative) or second (positive) of a pair

    @property
    def quality(self) -> float:
        return min(self.qualities)
