# SPDX-License-Identifier: MIT
"""A scripted rater's mind: what it answers to a trial and at the end."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from verisim.study.problems import refuse
from verisim.study.server.observer import Observer, Traits, manipulation, visible_error
from verisim.study.server.questions import Answer, Percept, Question
from verisim.study.server.questions.ask import Condition
from verisim.study.server.samplers import find_tracks
from verisim.study.server.stimulus_set import load_stimulus_set
from verisim.study.server.study_file import Study

Seen = tuple[float, tuple[str, float] | None]  # visible error, manipulation achieved
Answers = dict[str, Answer]  # by item


def look_at_clips(study: Study, set_dir: Path, traits: Traits | None) -> dict[str, Seen]:
    """Returns what raters see of each clip, by sha256. Refuses thresholds of unknown tracks."""
    sampler = find_tracks(study.order.sampler)
    tracks = sampler.tracks if sampler else ()
    unknown = set(traits.thresholds if traits else ()) - {track.name for track in tracks}
    if unknown:
        known = ", ".join(track.name for track in tracks) or "none"
        raise refuse("threshold", f"no track {sorted(unknown)[0]!r}", f"tracks: {known}")
    return {
        s.sha256: (visible_error(s), manipulation(s, tracks))
        for s in load_stimulus_set(set_dir).stimuli
    }


class Judge:
    """One scripted rater's judgement, drawn from its own random numbers."""

    def __init__(
        self, study: Study, seen: dict[str, Seen], rng: random.Random, traits: Traits | None
    ) -> None:
        self._study = study
        self._seen = seen
        self._rng = rng
        self._observer = Observer.draw(rng, traits)

    def describe(self) -> dict[str, Any]:
        """Returns the rater's traits, for the event that is stored with the data."""
        return self._observer.describe()

    def judge_trial(self, trial: dict[str, Any]) -> Iterator[tuple[Question, Answers]]:
        """Yields each question that is asked as things stand, and what is answered to it."""
        seen = [self._seen[clip["sha256"]] for clip in trial["clips"]]
        length_ms = 1000 * max(clip["duration_s"] for clip in trial["clips"])
        conditions = {key: Condition(**fields) for key, fields in trial["conditions"].items()}
        given: dict[tuple[str, str], Answer] = {}
        for question in map(self._study.question, trial["question_keys"]):
            if question.key in conditions and not conditions[question.key].holds(given):
                continue
            percept = self._observer.perceive(seen, length_ms, self._rng)
            answers = question.simulate(percept, self._rng)
            given |= {(question.key, item): answer for item, answer in answers.items()}
            yield question, answers

    def judge_session(self) -> Iterator[tuple[Question, Answers]]:
        """Yields each question of the end and its answer."""
        for question in self._study.end_questions:
            percept = Percept((self._rng.random(),), (self._rng.random() < 0.2,), 0.0)
            yield question, question.simulate(percept, self._rng)
