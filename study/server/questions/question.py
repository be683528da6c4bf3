# SPDX-License-Identifier: MIT
"""What a question kind declares: keys, check of an answer, codebook entry, simulated answer."""

from __future__ import annotations

import random
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from verisim.study.server.questions.answer import Answer, Percept, Scale
from verisim.study.server.questions.ask import Ask, read_ask
from verisim.study.server.questions.words import default_words, read_words
from verisim.study.server.yaml_source import Section

MAX_PROMPT_CHARS = 300


@dataclass(frozen=True)
class Question(ABC):
    """A question of a study: `key` names it in the data, `prompt` holds its words per language."""

    kind: ClassVar[str]
    is_free_text: ClassVar[bool] = False  # may hold personal data: kept in a table of its own
    is_about_clip: ClassVar[bool] = False  # makes no sense at the end of the session
    has_options: ClassVar[bool] = False  # their order on the screen can be reversed

    key: str
    prompt: dict[str, str]
    optional: bool
    ask: Ask

    @classmethod
    @abstractmethod
    def read(cls, section: Section, languages: Sequence[str]) -> Question:
        """Takes this kind's keys from the study file; problems are noted in the source."""

    def items(self) -> tuple[str, ...]:
        """Returns the names of the parts that are answered one by one; one part has no name."""
        return ("",)

    @abstractmethod
    def scale(self) -> Scale | None:
        """Returns the range of a numeric answer, None where there is none."""

    @abstractmethod
    def find_fault(self, answer: Answer) -> str | None:
        """Returns why this answer cannot be stored, None if it can. Skipped ones never get here."""

    def find_faults(self, answers: Mapping[str, Answer]) -> list[str]:
        """Returns what is wrong with the given answers, by item; skipped ones are left out."""
        items = self.items()
        faults = [f"unknown item {item!r}" for item in answers if item not in items]
        for item in items:
            if item in answers:
                if fault := self.find_fault(answers[item]):
                    faults.append(f"{item}: {fault}" if item else fault)
            elif not self.optional:
                faults.append(f"{item}: needs an answer" if item else "needs an answer")
        return faults

    @abstractmethod
    def page_fields(self, language: str) -> dict[str, Any]:
        """Returns what the page needs beyond key, kind, prompt and optional."""

    @abstractmethod
    def meaning(self, language: str) -> str:
        """Returns the codebook's sentence on this question's values."""

    @abstractmethod
    def simulate(self, percept: Percept, rng: random.Random) -> dict[str, Answer]:
        """Returns a scripted rater's answers by item."""


def read_common(
    section: Section, languages: Sequence[str], *, optional: bool = False, prompt: str | None = None
) -> dict[str, Any]:
    """Takes the keys that every kind has; prompt: name of default words."""
    key = section.name("key")
    if prompt is not None and not section.has("prompt"):
        words = default_words(section, "prompt", languages, prompt)
    else:
        words = read_words(section, "prompt", languages, None, max_chars=MAX_PROMPT_CHARS)
    return {
        "key": key,
        "prompt": words,
        "optional": section.flag("optional", optional),
        "ask": read_ask(section),
    }


def find_point_fault(answer: Answer, points: int) -> str | None:
    """The fault of an answer that must be one of the whole numbers 1..points."""
    if answer.value_text is not None:
        return "takes a number, not text"
    value = answer.value
    if value is None or value != int(value) or not 1 <= value <= points:
        return f"{value} is not one of the whole numbers 1 to {points}"
    return None
