# SPDX-License-Identifier: MIT
"""Question kind `emotion`: several feelings, each on the same n points."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from verisim.study.server.questions.answer import Answer, Percept, Scale
from verisim.study.server.questions.question import Question, find_point_fault, read_common
from verisim.study.server.questions.words import read_named, read_pair
from verisim.study.server.yaml_source import Section


@dataclass(frozen=True)
class EmotionQuestion(Question):
    """One answer per feeling, 1 at the first end to n at the second."""

    kind: ClassVar[str] = "emotion"

    feelings: dict[str, dict[str, str]]
    points: int
    ends: dict[str, list[str]]

    @classmethod
    def read(cls, section: Section, languages: Sequence[str]) -> EmotionQuestion:
        return cls(
            **read_common(section, languages, prompt="emotion_prompt"),
            feelings=read_named(section, "items", languages, 1, 12),
            points=section.integer("points", 2, 11, 5),
            ends=read_pair(section, "ends", languages, "emotion_ends"),
        )

    def items(self) -> tuple[str, ...]:
        return tuple(self.feelings)

    def scale(self) -> Scale:
        return Scale(1, self.points, 1)

    def find_fault(self, answer: Answer) -> str | None:
        return find_point_fault(answer, self.points)

    def page_fields(self, language: str) -> dict[str, Any]:
        feelings = self.feelings.items()
        return {
            "items": [{"key": name, "label": words[language]} for name, words in feelings],
            "points": self.points,
            "ends": self.ends[language],
        }

    def meaning(self, language: str) -> str:
        low, high = self.ends[language]
        return f"1 = {low}, {self.points} = {high}; one row per feeling"

    def simulate(self, percept: Percept, rng: random.Random) -> dict[str, Answer]:
        del percept  # feelings are a matter of taste
        return {item: Answer(float(rng.randint(1, self.points)), None) for item in self.items()}
