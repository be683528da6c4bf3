# SPDX-License-Identifier: MIT
"""Question kind `yes_no`: could it have happened like that, or was something wrong."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from verisim.study.server.questions.answer import Answer, Percept, Scale
from verisim.study.server.questions.question import Question, read_common
from verisim.study.server.questions.words import read_words
from verisim.study.server.yaml_source import Section


@dataclass(frozen=True)
class YesNoQuestion(Question):
    """1 = yes, 0 = no; `yes_means` says whether a yes finds the clip right or wrong."""

    kind: ClassVar[str] = "yes_no"
    has_options: ClassVar[bool] = True

    yes: dict[str, str]
    no: dict[str, str]
    yes_means: str  # right | wrong

    @classmethod
    def read(cls, section: Section, languages: Sequence[str]) -> YesNoQuestion:
        return cls(
            **read_common(section, languages),
            yes=read_words(section, "yes", languages, "yes"),
            no=read_words(section, "no", languages, "no"),
            yes_means=section.choice("yes_means", ("right", "wrong"), "right"),
        )

    def scale(self) -> Scale:
        return Scale(0, 1, 1)

    def find_fault(self, answer: Answer) -> str | None:
        if answer.value_text is not None or answer.value not in (0, 1):
            return f"{answer.value} is neither 1 (yes) nor 0 (no)"
        return None

    def finds_wrong(self, answer: Answer) -> bool:
        """True where the answer says that the clip was wrong."""
        return (answer.value == 1) == (self.yes_means == "wrong")

    def page_fields(self, language: str) -> dict[str, Any]:
        words = {1: self.yes[language], 0: self.no[language]}
        return {"options": [{"value": value, "label": label} for value, label in words.items()]}

    def meaning(self, language: str) -> str:
        return f"1 = {self.yes[language]}, 0 = {self.no[language]}"

    def simulate(self, percept: Percept, rng: random.Random) -> dict[str, Answer]:
        del rng
        return {"": Answer(float(any(percept.noticed) == (self.yes_means == "wrong")), None)}
