# SPDX-License-Identifier: MIT
"""Question kind `bipolar`: points whose middle is right and whose two ends are wrong."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from verisim.study.server.questions.answer import Answer, Percept, Scale
from verisim.study.server.questions.question import Question, find_point_fault, read_common
from verisim.study.server.questions.words import read_pair, read_words
from verisim.study.server.yaml_source import Section


@dataclass(frozen=True)
class BipolarQuestion(Question):
    """From 1 (too little) over the middle (right) to n (too much); none chosen beforehand."""

    kind: ClassVar[str] = "bipolar"

    points: int
    ends: dict[str, list[str]]
    middle: dict[str, str]

    @classmethod
    def read(cls, section: Section, languages: Sequence[str]) -> BipolarQuestion:
        return cls(
            **read_common(section, languages),
            points=section.choice("points", (3, 5, 7, 9, 11)),
            ends=read_pair(section, "ends", languages, None),
            middle=read_words(section, "middle", languages, None),
        )

    def scale(self) -> Scale:
        return Scale(1, self.points, 1)

    def find_fault(self, answer: Answer) -> str | None:
        return find_point_fault(answer, self.points)

    def page_fields(self, language: str) -> dict[str, Any]:
        labels = [""] * self.points
        labels[0], labels[-1] = self.ends[language]
        labels[self.points // 2] = self.middle[language]
        return {"points": self.points, "ends": self.ends[language], "labels": labels}

    def meaning(self, language: str) -> str:
        low, high = self.ends[language]
        middle = self.points // 2 + 1
        return f"1 = {low}, {middle} = {self.middle[language]}, {self.points} = {high}"

    def simulate(self, percept: Percept, rng: random.Random) -> dict[str, Answer]:
        # A fault is felt as too little or too much, either as likely; the better the clip, the
        # nearer the middle.
        half = self.points // 2
        away = round((1 - percept.quality) * half)
        return {"": Answer(half + 1 + rng.choice((-1, 1)) * away, None)}
