# SPDX-License-Identifier: MIT
"""Reads dataset_description.json: the columns it lists, their ranges, and the questions' scales."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from verisim.analysis.problems import Problem

DESCRIPTION_FILE = "dataset_description.json"


@dataclass(frozen=True)
class Question:
    """One question: its kind, the ends of its scale where known, the words shown."""

    key: str
    kind: str
    minimum: float | None = None
    maximum: float | None = None
    prompt: str = ""
    ends: tuple[str, str] = ("", "")


@dataclass(frozen=True)
class Variable:
    """One column as the codebook describes it. levels: the only values allowed, if listed."""

    name: str
    minimum: float | None = None
    maximum: float | None = None
    levels: tuple[str, ...] = ()


def variables(description: dict[str, Any]) -> dict[str, Variable]:
    """Columns by name. Psych-DS allows a bare name or a schema.org PropertyValue for each."""
    found = {}
    for item in _list(description.get("variableMeasured")):
        if isinstance(item, str):
            found[item] = Variable(item)
        elif isinstance(item, dict) and isinstance(item.get("name"), str):
            found[item["name"]] = Variable(
                item["name"],
                _number(item.get("minValue")),
                _number(item.get("maxValue")),
                _levels(item.get("levels")),
            )
    return found


def questions(description: dict[str, Any]) -> dict[str, Question]:
    """The study's questions, in the order asked; empty when the description names none."""
    found = {}
    for item in _list(description.get("questions")):
        if not isinstance(item, dict) or not isinstance(item.get("key"), str):
            continue
        kind = str(item.get("kind", ""))
        low, high = _scale(item, kind)
        ends = [str(end) for end in _list(_words(item.get("ends")))]
        found[item["key"]] = Question(
            item["key"],
            kind,
            low,
            high,
            str(_words(item.get("prompt")) or ""),
            (ends[0], ends[-1]) if len(ends) >= 2 else ("", ""),
        )
    return found


def is_blind(description: dict[str, Any]) -> bool:
    """Whether the export hides which clip is which."""
    study = description.get("study")
    return isinstance(study, dict) and study.get("blind") is True


def primary_question(description: dict[str, Any]) -> str:
    """Key of the question that the study named as its primary outcome; empty when it named none."""
    study = description.get("study")
    analysis = study.get("analysis") if isinstance(study, dict) else None
    return str(analysis.get("primary") or "") if isinstance(analysis, dict) else ""


def check_description(description: object) -> list[Problem]:
    """The Psych-DS rules for the root file."""
    if not isinstance(description, dict):
        return [_problem(None, None, "must be a JSON object", "an object", "export again")]
    problems = []
    for key in ("name", "description"):
        if not isinstance(description.get(key), str) or not description[key].strip():
            problems.append(
                _problem(key, _seen(description.get(key)), "is empty", "a text", "name it")
            )
    context = description.get("@context")
    if "schema.org" not in str(context):
        problems.append(
            _problem(
                "@context",
                _seen(context),
                "does not name schema.org",
                "https://schema.org/",
                "Psych-DS descriptions are JSON-LD in the schema.org vocabulary",
            )
        )
    kind = description.get("@type")
    if kind != "Dataset":
        problems.append(
            _problem("@type", _seen(kind), "is not Dataset", "Dataset", 'set "@type": "Dataset"')
        )
    if not _list(description.get("variableMeasured")):
        problems.append(
            _problem(
                "variableMeasured",
                _seen(description.get("variableMeasured")),
                "lists no columns",
                "a list with every column of every table",
                "the codebook lives here; export again",
            )
        )
    return problems


def _scale(item: dict[str, Any], kind: str) -> tuple[float | None, float | None]:
    points = _number(item.get("points"))
    if points is not None:
        return 1.0, points
    low, high = _number(item.get("min")), _number(item.get("max"))
    if kind == "slider":
        return (0.0 if low is None else low), (100.0 if high is None else high)
    return low, high


def _words(value: object) -> object:
    """A text of the study: itself, or its English form, or the first language given."""
    if isinstance(value, dict) and value:
        return value.get("en", next(iter(value.values())))
    return value


def _levels(value: object) -> tuple[str, ...]:
    if isinstance(value, dict):
        return tuple(str(key) for key in value)
    return tuple(
        str(item.get("value")) if isinstance(item, dict) else str(item) for item in _list(value)
    )


def _list(value: object) -> list[Any]:
    return value if isinstance(value, list) else []


def _number(value: object) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return None
    return float(value)


def _seen(value: object) -> str | None:
    return None if value is None else str(value)


def _problem(key: str | None, value: str | None, message: str, allowed: str, hint: str) -> Problem:
    return Problem(DESCRIPTION_FILE, None, key, value, message, allowed, hint)
