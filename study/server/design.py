# SPDX-License-Identifier: MIT
"""A study's design over its clips: what each participant sees, how long it takes, what is wrong."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from verisim.study.problems import Problem, StudyError, refuse
from verisim.study.server.questions import Question
from verisim.study.server.samplers import PlannedTrial, find_tracks, participant_seed, plan_order
from verisim.study.server.stimulus_set import StimulusSet, load_stimulus_set
from verisim.study.server.study_file import Study, load_study

# Seconds that people take, for the estimate of a session's length. Judgement, not measurement; the
# pilot's median replaces it in the protocol.
ANSWER_S = {
    "rating": 4.0,
    "bipolar": 4.0,
    "slider": 4.0,
    "yes_no": 2.0,
    "choice": 2.5,
    "category": 3.0,
    "fun": 3.0,
    "confidence": 2.5,
    "comment": 6.0,
    "mark": 8.0,
}
ITEM_S = 3.0  # of a question with several items
AROUND_S = 240.0  # welcome, consent, instructions, debrief
LISTS_LOOKED_AT = 40


@dataclass(frozen=True)
class Design:
    """What `verisim check STUDY` prints."""

    trials: dict[str, int]  # by trial kind, of one participant
    minutes: float
    cells: list[str]
    quota: int | None
    shown: Counter[str]  # how often each unit is shown over the lists that were looked at
    lists: int
    lines: list[str]  # what the sampler says of itself
    problems: list[str]


def find_design_problems(study: Study, clips: StimulusSet) -> list[str]:
    """Returns what makes the design impossible with these clips."""
    problems: list[str] = []
    order = study.order
    cells = order.cells(clips.stimuli)
    if order.between and len(cells) < 2:
        problems.append(
            f"order.between: {order.between.factor!r} has {len(cells)} levels among the clips"
        )
    for cell in cells or [""]:
        pool = order.pool(clips.stimuli, cell)
        where = f"{cell}: " if cell else ""
        if not pool.tests:
            problems.append(f"{where}no test clip to show; pairs: {order.pairs or 'none'}")
            continue
        problems += [f"{where}{fault}" for fault in order.sampler.find_problems(pool)]
        adaptive = find_tracks(order.sampler)
        if adaptive is not None and order.pairs:
            for track in adaptive.tracks:
                if any(not clip.reference for _, clip in track.clips(pool.stimuli)):
                    problems.append(f"{where}track {track.name!r}: a clip has no reference")
    unknown = set(study.practice.answers) - {s.name for s in clips.stimuli if s.role == "practice"}
    if unknown:
        problems.append(f"practice.answers: {sorted(unknown)[0]!r} is no practice clip of the set")
    return list(dict.fromkeys(problems))


def load_both(study_path: Path, set_dir: Path) -> tuple[Study, StimulusSet]:
    """Reads a study and its clips. Raises StudyError where they do not belong together."""
    study = load_study(study_path)
    stimulus_set = load_stimulus_set(set_dir)
    if stimulus_set.name != study.set:
        raise refuse(
            set_dir,
            f"holds the set {stimulus_set.name!r}; the study {study.name!r} shows {study.set!r}",
            "give the directory of that set, or change `set` in the study file",
        )
    return study, stimulus_set


def check_design(study: Study, clips: StimulusSet) -> None:
    """Refuses a design that cannot be carried out with these clips."""
    faults = find_design_problems(study, clips)
    if faults:
        hint = "see the whole design: `verisim check STUDY`"
        raise StudyError([Problem(str(study.path), fault, hint) for fault in faults])


def plan_of_list(study: Study, clips: StimulusSet, cell: str, list_no: int) -> list[PlannedTrial]:
    seed = participant_seed(study.order.seed, list_no, cell)
    layouts = study.trial.layouts
    return plan_order(study.order, clips.stimuli, layouts, seed, list_no, cell)


def plan_of_first(study: Study, clips: StimulusSet) -> list[PlannedTrial]:
    return plan_of_list(study, clips, study.order.cells(clips.stimuli)[0], 0)


def describe_design(study: Study, clips: StimulusSet) -> Design:
    """Returns the design; counts are empty where problems make it impossible."""
    problems = find_design_problems(study, clips)
    order = study.order
    quota = order.between.quota if order.between else None
    cells = order.cells(clips.stimuli)
    if problems:
        return Design({}, 0.0, cells, quota, Counter(), 0, [], problems)
    plan = plan_of_first(study, clips)
    shown: Counter[str] = Counter()
    for cell in cells:
        for list_no in range(LISTS_LOOKED_AT):
            for trial in plan_of_list(study, clips, cell, list_no):
                if trial.trial_kind in ("test", "repeat"):
                    shown[" | ".join(sorted(trial.clips)) or f"track {trial.track}"] += 1
    lines = [
        line for cell in cells for line in order.sampler.describe(order.pool(clips.stimuli, cell))
    ]
    return Design(
        dict(Counter(trial.trial_kind for trial in plan)),
        session_minutes(study, clips),
        cells,
        quota,
        shown,
        LISTS_LOOKED_AT,
        list(dict.fromkeys(lines)),
        [],
    )


def session_minutes(study: Study, clips: StimulusSet) -> float:
    """Returns the estimated length of a session, rests left out."""
    by_name = {s.name: s for s in clips.stimuli}
    usual_s = sum(s.duration_s for s in clips.stimuli) / len(clips.stimuli)
    pause_s = (sum(study.trial.fixation_ms) / 2 + study.trial.grey_ms) / 1000
    total = AROUND_S + answer_s(study.end_questions)
    for trial in plan_of_first(study, clips):
        lengths = [by_name[name].duration_s for name in trial.clips] or [usual_s]
        if trial.layout == "side_by_side":
            watch = max(lengths)
        elif trial.layout == "sequential":
            watch = 2 * sum(lengths) / len(lengths) + study.trial.gap_ms / 1000
        else:
            watch = lengths[0]
        total += pause_s + watch + answer_s(study.questions)
    return total / 60


def answer_s(questions: Sequence[Question]) -> float:
    total = 0.0
    for question in questions:
        items = question.items()
        each = ANSWER_S.get(question.kind)
        total += question.ask.share * (each if each is not None else ITEM_S * len(items))
    return total
