# SPDX-License-Identifier: MIT
"""Reads a study file: what is shown and asked, in which order. Strict; all problems at once."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from verisim.study.problems import Problem, StudyError
from verisim.study.server.questions import QUESTION_KINDS, Question
from verisim.study.server.samplers import SAMPLERS, Sampler
from verisim.study.server.study_text import StudyText, read_text
from verisim.study.server.yaml_source import Section, YamlSource, is_integer, is_text

SCHEMA = 1
SOURCES = ("lab", "link", "prolific", "mturk", "pilot", "simulated")


@dataclass(frozen=True)
class TrialLayout:
    """How one trial is shown."""

    layout: str  # single: one clip
    lock: str  # first_play: answers open after the first full play
    replays: int  # further plays allowed
    fixation_ms: list[int]  # pause before the clip, drawn between the two
    rest_every: int  # trials between offered rests; 0: none


@dataclass(frozen=True)
class Exclusion:
    """Rules that flag a participant in the export; nobody is dropped."""

    missed_catch: (
        int | None
    )  # flagged when at least so many catch clips were rated above the middle
    median_rt_below_ms: float | None


@dataclass(frozen=True)
class AnalysisPlan:
    """What the analysis is told beforehand."""

    primary: str  # key of the question that counts first
    equivalence_margin: float | None  # share of the scale's range


@dataclass(frozen=True)
class Study:
    """A study as its file describes it."""

    path: Path
    name: str
    title: str
    contact: str
    set: str
    languages: list[str]
    consent: dict[str, StudyText]
    instructions: dict[str, StudyText]
    thanks: dict[str, StudyText]
    trial: TrialLayout
    questions: list[Question]
    order: Sampler
    exclude: Exclusion
    analysis: AnalysisPlan

    def question(self, key: str) -> Question:
        return next(question for question in self.questions if question.key == key)

    def config_json(self) -> str:
        """Returns all that decides what participants see and how it is analysed, as JSON."""

        def texts(by_language: dict[str, StudyText]) -> dict[str, Any]:
            return {
                language: {"version": text.version, "sha256": text.sha256}
                for language, text in by_language.items()
            }

        config = {
            "schema": SCHEMA,
            "name": self.name,
            "title": self.title,
            "contact": self.contact,
            "set": self.set,
            "languages": self.languages,
            "consent": texts(self.consent),
            "instructions": texts(self.instructions),
            "thanks": texts(self.thanks),
            "trial": asdict(self.trial),
            "questions": [{"kind": q.kind, **asdict(q)} for q in self.questions],
            "order": {"sampler": self.order.name, **asdict(self.order)},
            "exclude": asdict(self.exclude),
            "analysis": asdict(self.analysis),
        }
        return json.dumps(config, ensure_ascii=False, sort_keys=True)

    def config_sha256(self) -> str:
        return hashlib.sha256(self.config_json().encode()).hexdigest()


def load_study(path: Path) -> Study:
    """Reads a study file and its texts. Raises StudyError with every problem of it."""
    source = YamlSource(path)
    top = Section(source, source.root)
    top.choice("schema", (SCHEMA,))
    name, title, contact = top.name("name"), top.text("title"), top.text("contact")
    set_name = top.name("set")
    languages = _read_languages(top)
    words = {"title": title or "", "contact": contact or ""}
    consent = _read_texts(top, "consent", languages, words, versioned=True)
    instructions = _read_texts(top, "instructions", languages, words)
    thanks = _read_texts(top, "thanks", languages, words)
    trial = _read_trial(top.section("trial"))
    questions = _read_questions(top, languages)
    order = _read_order(top.section("order"))
    exclude = _read_exclude(top.section("exclude", required=False))
    analysis = _read_analysis(top.section("analysis"), questions)
    top.finish()
    source.raise_problems()
    assert order is not None
    return Study(
        path, name, title, contact, set_name, languages, consent, instructions, thanks, trial,
        questions, order, exclude, analysis,
    )  # fmt: skip


def check_study(path: Path) -> list[Problem]:
    """Returns everything that is wrong with a study file; an empty list if nothing is."""
    try:
        load_study(path)
    except StudyError as error:
        return error.problems
    return []


def _read_languages(top: Section) -> list[str]:
    def accept(value: Any) -> bool:
        return (
            isinstance(value, list)
            and len(value) > 0
            and all(
                isinstance(v, str) and v.isascii() and v.isalpha() and len(v) in (2, 3)
                for v in value
            )
            and len(set(value)) == len(value)
        )

    allowed = "a list of two- or three-letter language codes, the first is the default"
    return top.take("languages", allowed, accept) or ["en"]


def _read_texts(
    top: Section,
    key: str,
    languages: Sequence[str],
    words: dict[str, str],
    *,
    versioned: bool = False,
) -> dict[str, StudyText]:
    """Takes a text file per language; a study in one language may name the file alone."""
    files = {languages[0]: top.value.get(key)}
    if len(languages) == 1 and not isinstance(top.value.get(key), dict):
        file = top.text(key)
        files = {languages[0]: file} if file else {}
    else:
        files = top.localized(key, languages, "a Markdown file", lambda v: is_text(v, 300))
    texts: dict[str, StudyText] = {}
    for language, file in files.items():
        if file is None:
            continue
        at = top.source.path.parent / file
        text, faults = read_text(at, words, versioned=versioned)
        for fault in faults:
            top.complain(key, f"{at}: {fault.message}", fault.hint)
        if text is not None:
            texts[language] = text
    return texts


def _read_trial(section: Section) -> TrialLayout:
    def is_fixation(value: Any) -> bool:
        return (
            isinstance(value, list)
            and len(value) == 2
            and all(is_integer(v) and 0 <= v <= 10_000 for v in value)
            and value[0] <= value[1]
        )

    layout = TrialLayout(
        layout=section.choice("layout", ("single",)),
        lock=section.choice("lock", ("first_play",), "first_play"),
        replays=section.integer("replays", 0, 20, 1),
        fixation_ms=section.take(
            "fixation_ms", "[low, high], whole ms from 0 to 10000", is_fixation, [500, 1500]
        ),
        rest_every=section.integer("rest_every", 0, 1000, 20),
    )
    section.finish()
    return layout


def _read_questions(top: Section, languages: Sequence[str]) -> list[Question]:
    items = top.take(
        "questions", "a list of questions", lambda v: isinstance(v, list) and len(v) > 0
    )
    questions: list[Question] = []
    keys: set[str] = set()
    for i, item in enumerate(items or []):
        section = Section(top.source, item, ("questions", i))
        kind_name = section.choice("kind", tuple(QUESTION_KINDS))
        if kind_name is None:
            continue  # which keys are allowed depends on the kind
        question = QUESTION_KINDS[kind_name].read(section, languages)
        section.finish()
        if question.key in keys:
            section.complain("key", f"{question.key!r} is used by two questions", "rename one")
        keys.add(question.key)
        questions.append(question)
    return questions


def _read_order(section: Section) -> Sampler | None:
    name = section.choice("sampler", tuple(SAMPLERS))
    if name is None:
        return None
    sampler = SAMPLERS[name].read(section)
    section.finish()
    return sampler


def _read_exclude(section: Section) -> Exclusion:
    exclude = Exclusion(
        missed_catch=section.integer("missed_catch", 1, 1000, None),
        median_rt_below_ms=section.number("median_rt_below_ms", 0, 60_000, None),
    )
    section.finish()
    return exclude


def _read_analysis(section: Section, questions: list[Question]) -> AnalysisPlan:
    numeric = tuple(q.key for q in questions if q.scale() is not None)
    plan = AnalysisPlan(
        primary=section.choice("primary", numeric),
        equivalence_margin=section.number("equivalence_margin", 0, 1, None),
    )
    section.finish()
    return plan
