# SPDX-License-Identifier: MIT
"""What the right answer to a trial would be, where there is one: catch, practice and pairs."""

from __future__ import annotations

import json
from typing import Any

from verisim.study.server.questions.yes_no import YesNoQuestion
from verisim.study.server.samplers import PlannedTrial
from verisim.study.server.study_file import Study

Expected = dict[str, Any]  # question, and `is` or `below` a value


def expected_answer(study: Study, trial: PlannedTrial) -> Expected | None:
    """Returns the answer that shows attention or is right; None where any answer is as good."""
    if len(trial.clips) == 2:
        return expected_choice(study, trial.clips, trial.target)
    if trial.trial_kind == "practice":
        practice = study.practice
        if practice.question is None or trial.clips[0] not in practice.answers:
            return None
        return {"question": practice.question, "is": practice.answers[trial.clips[0]]}
    if trial.trial_kind != "catch":
        return None
    primary = study.question(study.analysis.primary)
    if isinstance(primary, YesNoQuestion):
        return {"question": primary.key, "is": 1.0 if primary.yes_means == "wrong" else 0.0}
    scale = primary.scale()
    assert scale is not None  # the study file allows only a numeric primary question
    return {"question": primary.key, "below": (scale.min + scale.max) / 2}


def expected_choice(study: Study, clips: tuple[str, ...], target: str) -> Expected | None:
    """Returns which clip of a pair is the right one: 1 the first, 2 the second."""
    choice = next((q.key for q in study.questions if q.kind == "choice"), None)
    if choice is None or not target:
        return None
    return {"question": choice, "is": float(clips.index(target) + 1)}


def is_as_expected(expected: Expected, value: float | None) -> bool:
    """True where the answer's number is the expected one; no number is never right."""
    if value is None:
        return False
    return bool(value == expected["is"] if "is" in expected else value < expected["below"])


def read_expected(text: str | None) -> Expected | None:
    return None if text is None else dict(json.loads(text))
