# SPDX-License-Identifier: MIT
"""Question kinds with n points between two named ends: `rating`, `fun` and `confidence`."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from verisim.study.server.questions.answer import Answer, Percept, Scale
from verisim.study.server.questions.question import Question, find_point_fault, read_common
from verisim.study.server.questions.words import read_pair
from verisim.study.server.yaml_source import MISSING, Section


@dataclass(frozen=True)
class PointsQuestion(Question):
    """n points, 1 at the first end, n at the second; no point is chosen beforehand."""

    default_prompt: ClassVar[str | None] = None
    default_ends: ClassVar[str | None] = None
    default_points: ClassVar[Any] = MISSING
    most_points: ClassVar[int] = 11

    points: int
    ends: dict[str, list[str]]
    labels: dict[str, list[str]] | None  # one per point, '' where a point has no name

    @classmethod
    def read(cls, section: Section, languages: Sequence[str]) -> PointsQuestion:
        common = read_common(section, languages, prompt=cls.default_prompt)
        points = section.integer("points", 2, cls.most_points, cls.default_points)
        return cls(
            **common,
            points=points,
            ends=read_pair(section, "ends", languages, cls.default_ends),
            labels=read_labels(section, languages, points),
        )

    def scale(self) -> Scale:
        return Scale(1, self.points, 1)

    def find_fault(self, answer: Answer) -> str | None:
        return find_point_fault(answer, self.points)

    def page_fields(self, language: str) -> dict[str, Any]:
        labels = self.labels[language] if self.labels else None
        return {"points": self.points, "ends": self.ends[language], "labels": labels}

    def meaning(self, language: str) -> str:
        low, high = self.ends[language]
        return f"1 = {low}, {self.points} = {high}"

    def simulate(self, percept: Percept, rng: random.Random) -> dict[str, Answer]:
        del rng  # the observer's noise is already in the percept
        return {"": Answer(1 + round(percept.quality * (self.points - 1)), None)}


def read_labels(
    section: Section, languages: Sequence[str], points: int | None
) -> dict[str, list[str]] | None:
    """Takes the names of the single points, if there are any."""
    if not section.has("labels"):
        section.taken.append("labels")
        return None

    def accept(value: Any) -> bool:
        return (
            isinstance(value, list)
            and len(value) == points
            and all(isinstance(v, str) and len(v) <= 60 for v in value)
        )

    return section.localized("labels", languages, f"{points} texts, '' for none", accept)


@dataclass(frozen=True)
class RatingQuestion(PointsQuestion):
    """How much of something, e.g. realism."""

    kind: ClassVar[str] = "rating"


@dataclass(frozen=True)
class FunQuestion(PointsQuestion):
    """How much fun a clip was; words of our own where the study file gives none."""

    kind: ClassVar[str] = "fun"
    default_prompt: ClassVar[str | None] = "fun_prompt"
    default_ends: ClassVar[str | None] = "fun_ends"
    default_points: ClassVar[Any] = 5

    def simulate(self, percept: Percept, rng: random.Random) -> dict[str, Answer]:
        # Fun is not tied to realism alone: half of the answer is a matter of taste.
        felt = 0.5 * percept.quality + 0.5 * rng.random()
        return {"": Answer(1 + round(felt * (self.points - 1)), None)}


@dataclass(frozen=True)
class ConfidenceQuestion(PointsQuestion):
    """How sure somebody is of the answer before."""

    kind: ClassVar[str] = "confidence"
    default_prompt: ClassVar[str | None] = "confidence_prompt"
    default_ends: ClassVar[str | None] = "confidence_ends"
    default_points: ClassVar[Any] = 4
    most_points: ClassVar[int] = 5

    def simulate(self, percept: Percept, rng: random.Random) -> dict[str, Answer]:
        # Surer, the further what was felt lies from undecided.
        sure = min(1.0, abs(percept.quality - 0.5) * 2 + rng.gauss(0, 0.1))
        return {"": Answer(1 + round(max(0.0, sure) * (self.points - 1)), None)}
