# SPDX-License-Identifier: MIT
"""Question kind `rating`: one of n points between two named ends."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from verisim.study.server.questions.question import (
    Answer,
    Question,
    Scale,
    find_point_fault,
    read_ends,
    read_prompt,
)
from verisim.study.server.yaml_source import Section


@dataclass(frozen=True)
class RatingQuestion(Question):
    """n points, 1 at the first end, n at the second; no point is chosen beforehand."""

    kind: ClassVar[str] = "rating"

    points: int
    ends: dict[str, list[str]]

    @classmethod
    def read(cls, section: Section, languages: Sequence[str]) -> RatingQuestion:
        return cls(
            key=section.name("key"),
            prompt=read_prompt(section, languages),
            optional=section.flag("optional", False),
            points=section.integer("points", 2, 11),
            ends=read_ends(section, languages),
        )

    def scale(self) -> Scale:
        return Scale(1, self.points, 1)

    def find_fault(self, answer: Answer) -> str | None:
        return find_point_fault(answer, self.points)

    def page_fields(self, language: str) -> dict[str, Any]:
        return {"points": self.points, "ends": self.ends[language]}

    def meaning(self, language: str) -> str:
        low, high = self.ends[language]
        return f"1 = {low}, {self.points} = {high}"

    def simulate(self, quality: float, rng: random.Random) -> Answer:
        del rng  # the observer's noise is already in `quality`
        return Answer(1 + round(quality * (self.points - 1)), None)
