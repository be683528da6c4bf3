# SPDX-License-Identifier: MIT
"""Question kind `checklist`: law by law, was it kept, violated, or can one not tell."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from verisim.study.server.questions.answer import Answer, Percept, Scale
from verisim.study.server.questions.question import Question, read_common
from verisim.study.server.questions.words import default_words, read_named
from verisim.study.server.yaml_source import Section

STATES: dict[str, float | None] = {"kept": 1.0, "violated": 0.0, "cannot_tell": None}
CANNOT_TELL_SHARE = 0.1  # of a scripted rater's answers


@dataclass(frozen=True)
class ChecklistQuestion(Question):
    """One answer per law: 1 = kept, 0 = violated, empty = cannot tell; the word is kept as text."""

    kind: ClassVar[str] = "checklist"

    laws: dict[str, dict[str, str]]
    states: dict[str, dict[str, str]]

    @classmethod
    def read(cls, section: Section, languages: Sequence[str]) -> ChecklistQuestion:
        return cls(
            **read_common(section, languages),
            laws=read_named(section, "items", languages, 1, 12),
            states={state: default_words(section, state, languages, state) for state in STATES},
        )

    def items(self) -> tuple[str, ...]:
        return tuple(self.laws)

    def scale(self) -> Scale:
        return Scale(0, 1, 1)

    def find_fault(self, answer: Answer) -> str | None:
        text = answer.value_text or ""
        if text not in STATES or STATES[text] != answer.value:
            return "takes 1 with `kept`, 0 with `violated`, or no number with `cannot_tell`"
        return None

    def page_fields(self, language: str) -> dict[str, Any]:
        return {
            "items": [{"key": law, "label": words[language]} for law, words in self.laws.items()],
            "states": [
                {"value": value, "value_text": state, "label": self.states[state][language]}
                for state, value in STATES.items()
            ],
        }

    def meaning(self, language: str) -> str:
        del language
        return "1 = kept, 0 = violated, empty = cannot tell; one row per law"

    def simulate(self, percept: Percept, rng: random.Random) -> dict[str, Answer]:
        # A noticed fault is put down to one law; the others look kept.
        blamed = rng.choice(self.items()) if any(percept.noticed) else None
        answers: dict[str, Answer] = {}
        for law in self.items():
            state = "violated" if law == blamed else "kept"
            if rng.random() < CANNOT_TELL_SHARE:
                state = "cannot_tell"
            answers[law] = Answer(STATES[state], state)
        return answers
