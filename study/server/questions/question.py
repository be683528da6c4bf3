# SPDX-License-Identifier: MIT
"""What a question kind declares: keys, check of an answer, codebook entry, simulated answer."""

from __future__ import annotations

import random
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

from verisim.study.server.yaml_source import Section, is_text

MAX_PROMPT_CHARS = 300


class Scale(NamedTuple):
    """The values a numeric question takes."""

    min: float
    max: float
    step: float


class Answer(NamedTuple):
    """What was answered: a number, a text, or neither (skipped)."""

    value: float | None
    value_text: str | None


@dataclass(frozen=True)
class Question(ABC):
    """A question of a study: `key` names it in the data, `prompt` holds its words per language."""

    kind: ClassVar[str]

    key: str
    prompt: dict[str, str]
    optional: bool

    @classmethod
    @abstractmethod
    def read(cls, section: Section, languages: Sequence[str]) -> Question:
        """Takes this kind's keys from the study file; problems are noted in the source."""

    @abstractmethod
    def scale(self) -> Scale | None:
        """Returns the range of a numeric answer, None where the answer is text."""

    @abstractmethod
    def find_fault(self, answer: Answer) -> str | None:
        """Returns why this answer cannot be stored, None if it can. Skipped ones never get here."""

    @abstractmethod
    def page_fields(self, language: str) -> dict[str, Any]:
        """Returns what the page needs beyond key, kind, prompt and optional."""

    @abstractmethod
    def meaning(self, language: str) -> str:
        """Returns the codebook's sentence on this question's values."""

    @abstractmethod
    def simulate(self, quality: float, rng: random.Random) -> Answer:
        """Returns a scripted rater's answer; quality: as felt, 0 (plainly wrong) to 1 (right)."""


def read_prompt(section: Section, languages: Sequence[str]) -> dict[str, str]:
    allowed = f"one question text of at most {MAX_PROMPT_CHARS} characters"
    return section.localized("prompt", languages, allowed, lambda v: is_text(v, MAX_PROMPT_CHARS))


def read_ends(section: Section, languages: Sequence[str]) -> dict[str, list[str]]:
    """Takes the words at the two ends of a scale."""

    def accept(value: Any) -> bool:
        return isinstance(value, list) and len(value) == 2 and all(is_text(v, 60) for v in value)

    return section.localized("ends", languages, "two texts, [low end, high end]", accept)


def find_point_fault(answer: Answer, points: int) -> str | None:
    """The fault of an answer that must be one of the whole numbers 1..points."""
    if answer.value_text is not None:
        return "takes a number, not text"
    value = answer.value
    if value is None or value != int(value) or not 1 <= value <= points:
        return f"{value} is not one of the whole numbers 1 to {points}"
    return None
