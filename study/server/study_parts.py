# SPDX-License-Identifier: MIT
"""The smaller parts of a study file: trial, screen, practice, completion, exclusion, analysis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlsplit

from verisim.study.server.questions import Question
from verisim.study.server.yaml_source import Section, is_integer, is_number

LAYOUTS = ("single", "sequential", "side_by_side")


@dataclass(frozen=True)
class TrialLayout:
    """How one trial is shown."""

    layouts: list[str]
    lock: str  # first_play: answers open after the first full play
    replays: int  # further plays allowed
    fixation_ms: list[int]  # pause before the clip, drawn between the two
    rest_every: int  # trials between offered rests; 0: none
    rest_min_s: int  # a rest lasts at least so long
    grey_ms: int  # plain grey between fixation and clip
    gap_ms: int  # grey between the two clips of a pair

    @property
    def layout(self) -> str:
        return self.layouts[0]


def read_trial(section: Section) -> TrialLayout:
    def is_fixation(value: Any) -> bool:
        return (
            isinstance(value, list)
            and len(value) == 2
            and all(is_integer(v) and 0 <= v <= 10_000 for v in value)
            and value[0] <= value[1]
        )

    def is_layout(value: Any) -> bool:
        if isinstance(value, list):
            return (
                len(set(value)) == len(value) > 0
                and all(v in LAYOUTS for v in value)
                and ("single" not in value or len(value) == 1)
            )
        return value in LAYOUTS

    layout = section.take("layout", f"{' | '.join(LAYOUTS)}, or a list of the last two", is_layout)
    read = TrialLayout(
        layouts=layout if isinstance(layout, list) else [layout or "single"],
        lock=section.choice("lock", ("first_play",), "first_play"),
        replays=section.integer("replays", 0, 20, 1),
        fixation_ms=section.take(
            "fixation_ms", "[low, high], whole ms from 0 to 10000", is_fixation, [500, 1500]
        ),
        rest_every=section.integer("rest_every", 0, 1000, 20),
        rest_min_s=section.integer("rest_min_s", 0, 600, 0),
        grey_ms=section.integer("grey_ms", 0, 10_000, 0),
        gap_ms=section.integer("gap_ms", 0, 10_000, 500),
    )
    section.finish()
    return read


@dataclass(frozen=True)
class ScreenRules:
    """What the screen must be like."""

    phone: str  # allow | refuse
    min_viewport_px: list[int] | None  # CSS px, where the clips need less
    refresh: str  # ignore | flag | refuse
    codec: bool
    fullscreen: str  # off | offer | require
    calibration: str  # off | offer | require
    distance_mm: list[float] | None  # [least, usual, most]; None: not asked
    px_per_degree: list[float] | None  # device px: [least, most]


def read_screen(section: Section) -> ScreenRules:
    def are_px(value: Any) -> bool:
        return _are_numbers(value, 2) and all(is_integer(v) and 1 <= v <= 20_000 for v in value)

    def are_mm(value: Any) -> bool:
        return _are_numbers(value, 3) and 100 <= value[0] <= value[1] <= value[2] <= 5000

    def are_ppd(value: Any) -> bool:
        return _are_numbers(value, 2) and 0 < value[0] < value[1] <= 1000

    rules = ScreenRules(
        phone=section.choice("phone", ("allow", "refuse"), "refuse"),
        min_viewport_px=section.take("min_viewport_px", "[width, height] in CSS px", are_px, None),
        refresh=section.choice("refresh", ("ignore", "flag", "refuse"), "flag"),
        codec=section.flag("codec", True),
        fullscreen=section.choice("fullscreen", ("off", "offer", "require"), "offer"),
        calibration=section.choice("calibration", ("off", "offer", "require"), "off"),
        distance_mm=section.take("distance_mm", "[least, usual, most] in mm", are_mm, None),
        px_per_degree=section.take("px_per_degree", "[least, most], device px", are_ppd, None),
    )
    if rules.px_per_degree and (rules.calibration == "off" or rules.distance_mm is None):
        section.complain(
            "px_per_degree",
            "needs the screen's size and the viewing distance",
            "add `calibration: require` and `distance_mm: [300, 600, 1500]`",
        )
    section.finish()
    return rules


def _are_numbers(value: Any, num: int) -> bool:
    return isinstance(value, list) and len(value) == num and all(is_number(v) for v in value)


@dataclass(frozen=True)
class Practice:
    """Whether practice trials say what was right, and what is."""

    feedback: bool
    question: str | None
    answers: dict[str, float]  # by the name of a practice clip


def read_practice(section: Section, questions: Sequence[Question]) -> Practice:
    keys = tuple(q.key for q in questions if q.kind in ("yes_no", "choice"))
    feedback = section.flag("feedback", False)
    question = section.choice("question", keys, None)
    answers: dict[str, float] = {}
    if section.has("answers"):
        inner = section.section("answers")
        for clip in inner.value:
            value = inner.choice(clip, (0, 1))
            answers[clip] = float(value or 0)
    else:
        section.taken.append("answers")
    if feedback and question is None:
        section.complain("question", "missing; feedback needs a yes_no or choice question")
    section.finish()
    return Practice(bool(feedback), question, answers)


@dataclass(frozen=True)
class Ending:
    """What a participant gets at one of the ways in which a session ends."""

    code: str | None  # None: a random code per participant
    return_url: str | None  # with {code} where the code goes


@dataclass(frozen=True)
class Completion:
    complete: Ending
    partial: Ending | None  # None: stopping early earns nothing
    partial_from_share: float  # of the trials
    screened_out: Ending | None


def read_completion(section: Section) -> Completion:
    complete = _read_ending(section)
    partial, share, screened_out = None, 0.0, None
    if section.has("partial"):
        inner = section.section("partial")
        share = inner.number("from_share", 0, 1, 0.0)
        partial = _read_ending(inner)
        inner.finish()
    if section.has("screened_out"):
        inner = section.section("screened_out")
        screened_out = _read_ending(inner)
        inner.finish()
    section.taken += ["partial", "screened_out"]
    section.finish()
    return Completion(complete, partial, share or 0.0, screened_out)


def _read_ending(section: Section) -> Ending:
    def is_code(value: Any) -> bool:
        return isinstance(value, str) and value.isascii() and value.isalnum() and len(value) <= 40

    def is_url(value: Any) -> bool:
        if not isinstance(value, str) or len(value) > 500 or any(c.isspace() for c in value):
            return False
        parts = urlsplit(value.replace("{code}", "CODE"))
        return parts.scheme == "https" and bool(parts.netloc)

    return Ending(
        code=section.take("code", "letters and digits", is_code, None),
        return_url=section.take("return_url", "an https address, {code} in it", is_url, None),
    )


@dataclass(frozen=True)
class Exclusion:
    """Rules that flag a participant in the export; nobody is dropped."""

    missed_catch: int | None  # flagged when at least so many catch trials were answered wrongly
    median_rt_below_ms: float | None
    equal_answers_run: int | None = None  # longest run of one answer to the primary question
    frames_dropped_share: float | None = None  # of all frames of test trials
    hidden_ms: float | None = None  # page out of sight while clips played, in all

    def rules(self) -> dict[str, float | None]:
        return dict(self.__dict__)


def read_exclude(section: Section) -> Exclusion:
    exclude = Exclusion(
        missed_catch=section.integer("missed_catch", 1, 1000, None),
        median_rt_below_ms=section.number("median_rt_below_ms", 0, 60_000, None),
        equal_answers_run=section.integer("equal_answers_run", 2, 10_000, None),
        frames_dropped_share=section.number("frames_dropped_share", 0, 1, None),
        hidden_ms=section.number("hidden_ms", 0, 1e9, None),
    )
    section.finish()
    return exclude


@dataclass(frozen=True)
class AnalysisPlan:
    """What the analysis is told beforehand."""

    primary: str  # key of the question that counts first
    equivalence_margin: float | None  # share of the scale's range


def read_analysis(section: Section, questions: Sequence[Question]) -> AnalysisPlan:
    numeric = tuple(q.key for q in questions if q.scale() is not None and q.items() == ("",))
    plan = AnalysisPlan(
        primary=section.choice("primary", numeric),
        equivalence_margin=section.number("equivalence_margin", 0, 1, None),
    )
    section.finish()
    return plan


def degrees_to_px(css_px_per_mm: float, device_pixel_ratio: float, distance_mm: float) -> float:
    """Returns device pixels per degree of visual angle at the middle of the screen."""
    return css_px_per_mm * device_pixel_ratio * distance_mm * 2 * math.tan(math.radians(0.5))
