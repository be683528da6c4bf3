# SPDX-License-Identifier: MIT
"""Question kind `comment`: a short free text."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from verisim.study.server.questions.answer import Answer, Percept
from verisim.study.server.questions.question import Question, read_common
from verisim.study.server.yaml_source import Section

MAX_CHARS = 2000
SIMULATED_SHARE = 0.2  # of the clips that a scripted rater comments on
SIMULATED_WORDS = ("it looked wrong", "something was off", "almost real", "looked real to me")


@dataclass(frozen=True)
class CommentQuestion(Question):
    """Text of at most `max_chars` characters; kept apart, for it may hold personal data."""

    kind: ClassVar[str] = "comment"
    is_free_text: ClassVar[bool] = True

    max_chars: int

    @classmethod
    def read(cls, section: Section, languages: Sequence[str]) -> CommentQuestion:
        return cls(
            **read_common(section, languages, optional=True),
            max_chars=section.integer("max_chars", 1, MAX_CHARS, 200),
        )

    def scale(self) -> None:
        return None

    def find_fault(self, answer: Answer) -> str | None:
        if answer.value is not None:
            return "takes text, not a number"
        text = answer.value_text or ""
        if len(text) > self.max_chars:
            return f"has {len(text)} characters; at most {self.max_chars} are kept"
        return None

    def page_fields(self, language: str) -> dict[str, Any]:
        del language
        return {"max_chars": self.max_chars}

    def meaning(self, language: str) -> str:
        del language
        return f"free text of at most {self.max_chars} characters"

    def simulate(self, percept: Percept, rng: random.Random) -> dict[str, Answer]:
        if self.optional and rng.random() > SIMULATED_SHARE:
            return {}
        words = SIMULATED_WORDS[min(3, int(percept.quality * 4))]
        return {"": Answer(None, f"simulated: {words}"[: self.max_chars])}
