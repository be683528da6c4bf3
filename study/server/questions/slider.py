# SPDX-License-Identifier: MIT
"""Question kind `slider`: 0 to 100 between two named ends, no thumb until the first touch."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from verisim.study.server.questions.answer import Answer, Percept, Scale
from verisim.study.server.questions.question import Question, read_common
from verisim.study.server.questions.words import read_pair
from verisim.study.server.yaml_source import Section

SLIDER = Scale(0, 100, 1)


@dataclass(frozen=True)
class SliderQuestion(Question):
    """0 at the first end, 100 at the second."""

    kind: ClassVar[str] = "slider"

    ends: dict[str, list[str]]

    @classmethod
    def read(cls, section: Section, languages: Sequence[str]) -> SliderQuestion:
        return cls(
            **read_common(section, languages),
            ends=read_pair(section, "ends", languages, None),
        )

    def scale(self) -> Scale:
        return SLIDER

    def find_fault(self, answer: Answer) -> str | None:
        if answer.value_text is not None:
            return "takes a number, not text"
        if answer.value is None or not SLIDER.min <= answer.value <= SLIDER.max:
            return f"{answer.value} is not a number from {SLIDER.min:g} to {SLIDER.max:g}"
        return None

    def page_fields(self, language: str) -> dict[str, Any]:
        return {"ends": self.ends[language], **SLIDER._asdict()}

    def meaning(self, language: str) -> str:
        low, high = self.ends[language]
        return f"{SLIDER.min:g} = {low}, {SLIDER.max:g} = {high}"

    def simulate(self, percept: Percept, rng: random.Random) -> dict[str, Answer]:
        # A slider is not tied to realism alone: half of the answer is a matter of taste.
        return {"": Answer(round(100 * (0.5 * percept.quality + 0.5 * rng.random())), None)}
