# SPDX-License-Identifier: MIT
"""Question kind `choice`: which of two clips, one after the other or side by side."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from verisim.study.server.questions.answer import Answer, Percept, Scale
from verisim.study.server.questions.question import Question, read_common
from verisim.study.server.questions.words import default_words, read_pair
from verisim.study.server.yaml_source import Section

NOT_SURE = "not_sure"
UNDECIDED = 0.04  # a smaller felt difference makes a scripted rater take "not sure"


@dataclass(frozen=True)
class ChoiceQuestion(Question):
    """1 = first or left clip, 2 = second or right clip; `not_sure` as text where it is offered."""

    kind: ClassVar[str] = "choice"
    is_about_clip: ClassVar[bool] = True

    sequential: dict[str, list[str]]
    side_by_side: dict[str, list[str]]
    not_sure: dict[str, str] | None

    @classmethod
    def read(cls, section: Section, languages: Sequence[str]) -> ChoiceQuestion:
        common = read_common(section, languages)
        offered = section.flag("not_sure", False)
        return cls(
            **common,
            sequential=read_pair(section, "sequential", languages, "sequential"),
            side_by_side=read_pair(section, "side_by_side", languages, "side_by_side"),
            not_sure=default_words(section, "not_sure", languages, NOT_SURE) if offered else None,
        )

    def scale(self) -> Scale:
        return Scale(1, 2, 1)

    def find_fault(self, answer: Answer) -> str | None:
        if answer.value is None and self.not_sure and answer.value_text == NOT_SURE:
            return None
        if answer.value_text is not None or answer.value not in (1, 2):
            more = f" nor {NOT_SURE!r}" if self.not_sure else ""
            return f"{answer.value} is neither 1 nor 2{more}"
        return None

    def page_fields(self, language: str) -> dict[str, Any]:
        options = {
            layout: [{"value": i + 1, "label": label} for i, label in enumerate(words[language])]
            for layout, words in (
                ("sequential", self.sequential),
                ("side_by_side", self.side_by_side),
            )
        }
        words = self.not_sure
        not_sure = {"value_text": NOT_SURE, "label": words[language]} if words else None
        return {"options": options, "not_sure": not_sure}

    def meaning(self, language: str) -> str:
        del language
        more = f"; empty with text {NOT_SURE!r} = not sure" if self.not_sure else ""
        return f"1 = first or left clip (stimulus), 2 = second or right (stimulus_b){more}"

    def simulate(self, percept: Percept, rng: random.Random) -> dict[str, Answer]:
        del rng
        first, second = percept.qualities
        difference = second - first + percept.lean
        if self.not_sure and abs(difference) < UNDECIDED:
            return {"": Answer(None, NOT_SURE)}
        return {"": Answer(2.0 if difference > 0 else 1.0, None)}
