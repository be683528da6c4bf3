# SPDX-License-Identifier: MIT
"""Question kind `mark`: where in the clip did it look wrong."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from verisim.study.server.questions.answer import Answer, Percept
from verisim.study.server.questions.question import Question, read_common
from verisim.study.server.questions.words import read_words
from verisim.study.server.yaml_source import Section

NONE = "none"
MAX_MS = 600_000.0


@dataclass(frozen=True)
class MarkQuestion(Question):
    """Up to `max_marks` times in the clip (ms), items m1, m2, …; or the text `none`."""

    kind: ClassVar[str] = "mark"
    is_about_clip: ClassVar[bool] = True

    max_marks: int
    none: dict[str, str]

    @classmethod
    def read(cls, section: Section, languages: Sequence[str]) -> MarkQuestion:
        return cls(
            **read_common(section, languages, optional=True),
            max_marks=section.integer("max_marks", 1, 5, 1),
            none=read_words(section, "none", languages, "none"),
        )

    def items(self) -> tuple[str, ...]:
        return tuple(f"m{i + 1}" for i in range(self.max_marks))

    def scale(self) -> None:
        return None

    def find_fault(self, answer: Answer) -> str | None:
        if answer.value_text is not None or answer.value is None:
            return "takes a time in ms"
        if not 0 <= answer.value <= MAX_MS:
            return f"{answer.value} is not a time from 0 to {MAX_MS:g} ms"
        return None

    def find_faults(self, answers: Mapping[str, Answer]) -> list[str]:
        if not answers:
            return [] if self.optional else ["needs an answer"]
        if dict(answers) == {"": Answer(None, NONE)}:
            return []
        given = [item for item in self.items() if item in answers]
        faults = [f"unknown item {item!r}" for item in answers if item not in given]
        if given != list(self.items())[: len(given)]:
            faults.append("marks are numbered m1, m2, … without a gap")
        for item in given:
            if fault := self.find_fault(answers[item]):
                faults.append(f"{item}: {fault}")
        return faults

    def page_fields(self, language: str) -> dict[str, Any]:
        return {"max_marks": self.max_marks, "none_label": self.none[language]}

    def meaning(self, language: str) -> str:
        del language
        return f"time in the clip in ms where it looked wrong; text {NONE!r}: nowhere"

    def simulate(self, percept: Percept, rng: random.Random) -> dict[str, Answer]:
        if not any(percept.noticed):
            return {"": Answer(None, NONE)}
        return {"m1": Answer(round(rng.uniform(0.2, 0.9) * percept.duration_ms), None)}
