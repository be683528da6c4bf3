# SPDX-License-Identifier: MIT
"""Question kind `category`: one of several named kinds of thing."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from verisim.study.server.questions.answer import Answer, Percept
from verisim.study.server.questions.question import Question, read_common
from verisim.study.server.questions.words import read_named
from verisim.study.server.yaml_source import Section


@dataclass(frozen=True)
class CategoryQuestion(Question):
    """The answer is the code of one option, stored as text."""

    kind: ClassVar[str] = "category"
    has_options: ClassVar[bool] = True

    options: dict[str, dict[str, str]]

    @classmethod
    def read(cls, section: Section, languages: Sequence[str]) -> CategoryQuestion:
        common = read_common(section, languages)
        return cls(**common, options=read_named(section, "options", languages, 2, 12))

    def scale(self) -> None:
        return None

    def find_fault(self, answer: Answer) -> str | None:
        if answer.value is not None or answer.value_text not in self.options:
            return f"takes one of the texts {', '.join(self.options)}"
        return None

    def page_fields(self, language: str) -> dict[str, Any]:
        options = self.options.items()
        return {"options": [{"value_text": code, "label": w[language]} for code, w in options]}

    def meaning(self, language: str) -> str:
        return ", ".join(f"{code} = {words[language]}" for code, words in self.options.items())

    def simulate(self, percept: Percept, rng: random.Random) -> dict[str, Answer]:
        # The first option is the one that fits a clip without fault.
        codes = list(self.options)
        is_first = rng.random() < percept.quality
        return {"": Answer(None, codes[0] if is_first else rng.choice(codes[1:]))}
