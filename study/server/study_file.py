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
from verisim.study.server.data_note import data_note
from verisim.study.server.questions import QUESTION_KINDS, Question
from verisim.study.server.questions.ask import Ask
from verisim.study.server.samplers import Order, find_tracks, order_json, read_order
from verisim.study.server.study_parts import (
    AnalysisPlan,
    Completion,
    Exclusion,
    Practice,
    ScreenRules,
    TrialLayout,
    read_analysis,
    read_completion,
    read_exclude,
    read_practice,
    read_screen,
    read_trial,
)
from verisim.study.server.study_text import StudyText, read_text
from verisim.study.server.yaml_source import Section, YamlSource, is_text

SCHEMA = 1
SOURCES = ("lab", "link", "prolific", "mturk", "pilot", "simulated")


@dataclass(frozen=True)
class Study:
    """A study as its file describes it."""

    path: Path
    name: str
    title: dict[str, str]  # by language
    contact: dict[str, str]
    set: str
    languages: list[str]
    consent: dict[str, StudyText]
    instructions: dict[str, StudyText]
    thanks: dict[str, StudyText]
    trial: TrialLayout
    screen: ScreenRules | None
    practice: Practice
    questions: list[Question]
    end_questions: list[Question]
    order: Order
    completion: Completion
    links: str  # open: anybody may take part; required: only who has a participant link
    exclude: Exclusion
    analysis: AnalysisPlan

    def question(self, key: str) -> Question:
        return next(q for q in [*self.questions, *self.end_questions] if q.key == key)

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
            "trial": {"layout": self.trial.layout, **asdict(self.trial)},
            "screen": asdict(self.screen) if self.screen else None,
            "practice": asdict(self.practice),
            "questions": [{"kind": q.kind, **asdict(q)} for q in self.questions],
            "end_questions": [{"kind": q.kind, **asdict(q)} for q in self.end_questions],
            "order": order_json(self.order),
            "completion": asdict(self.completion),
            "links": self.links,
            "exclude": self.exclude.rules(),
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
    name, set_name = top.name("name"), top.name("set")
    languages = _read_languages(top)
    title, contact = (_read_line(top, key, languages) for key in ("title", "contact"))
    trial = read_trial(top.section("trial"))
    screen = read_screen(top.section("screen")) if top.has("screen") else None
    questions = _read_questions(top, "questions", languages)
    practice = read_practice(top.section("practice", required=False), questions)
    end_questions = _read_questions(top, "end_questions", languages)
    order = read_order(top.section("order"))
    completion = read_completion(top.section("completion", required=False))
    links = top.choice("links", ("open", "required"), "open")
    exclude = read_exclude(top.section("exclude", required=False))
    analysis = read_analysis(top.section("analysis"), questions)
    words = {
        language: {"title": title.get(language) or "", "contact": contact.get(language) or ""}
        for language in languages
    }
    notes = {
        language: data_note(language, screen, [*questions, *end_questions], links)
        for language in languages
    }
    consent = _read_texts(top, "consent", languages, words, notes=notes)
    instructions = _read_texts(top, "instructions", languages, words)
    thanks = _read_texts(top, "thanks", languages, words)
    top.taken.append("screen")
    top.finish()
    if order is not None:
        _check_together(top, trial, questions, end_questions, order)
    source.raise_problems()
    assert order is not None
    return Study(
        path, name, title, contact, set_name, languages, consent, instructions, thanks, trial,
        screen, practice, questions, end_questions, order, completion, links, exclude, analysis,
    )  # fmt: skip


def _check_together(
    top: Section,
    trial: TrialLayout,
    questions: list[Question],
    end_questions: list[Question],
    order: Order,
) -> None:
    """Reports parts that are right alone and wrong together."""
    is_pair = trial.layout != "single"
    if is_pair != (order.pairs is not None):
        top.complain(
            "order",
            "pairs need a layout of two clips, and such a layout needs pairs",
            "add `pairs: {with: reference}`, or write `layout: single`",
        )
    keys: set[str] = set()
    for place, asked in (("questions", questions), ("end_questions", end_questions)):
        seen: dict[str, Question] = {}
        for question in asked:
            if question.key in keys:
                top.complain(place, f"the key {question.key!r} is used by two questions")
            keys.add(question.key)
            if place == "end_questions" and question.is_about_clip:
                top.complain(place, f"{question.key}: a {question.kind} question needs a clip")
            if question.kind == "choice" and not is_pair:
                top.complain(place, f"{question.key}: a choice needs a layout of two clips")
            if question.kind == "mark" and is_pair:
                top.complain(
                    place,
                    f"{question.key}: a mark needs a layout of one clip",
                    "write `layout: single`, or remove the question",
                )
            if place == "end_questions" and question.ask != Ask():
                top.complain(place, f"{question.key}: is asked always; remove its `ask`")
            rule = question.ask.condition
            if rule is not None:
                other = seen.get(rule.question)
                if other is None:
                    top.complain(
                        place,
                        f"{question.key}: ask.if names {rule.question!r}, which does not come "
                        "before it",
                        "put that question first, or correct the name",
                    )
                elif rule.item not in other.items():
                    top.complain(place, f"{question.key}: ask.if names an unknown item")
            seen[question.key] = question
    tracks = find_tracks(order.sampler)
    if tracks is not None:
        kind = next((q.kind for q in questions if q.key == tracks.question), None)
        if kind != ("choice" if is_pair else "yes_no"):
            top.complain(
                "order",
                f"question {tracks.question!r} cannot lead the tracks",
                "name a yes_no question, or with pairs a choice",
            )


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


def _read_line(top: Section, key: str, languages: Sequence[str]) -> dict[str, str]:
    """Takes one text for all languages, or one for each."""
    if isinstance(top.value.get(key), dict):
        return top.localized(key, languages, "a text", lambda v: is_text(v, 500))
    return dict.fromkeys(languages, top.text(key) or "")


def _read_texts(
    top: Section,
    key: str,
    languages: Sequence[str],
    words: dict[str, dict[str, str]],
    *,
    notes: dict[str, str] | None = None,
) -> dict[str, StudyText]:
    """Takes a text file per language; a study in one language may name the file alone.

    notes: the generated data-protection note per language, for the consent form.
    """
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
        text, faults = read_text(at, words[language], note=notes[language] if notes else None)
        for fault in faults:
            top.complain(key, f"{at}: {fault.message}", fault.hint)
        if text is not None:
            texts[language] = text
    return texts


def _read_questions(top: Section, key: str, languages: Sequence[str]) -> list[Question]:
    required = key == "questions"

    def is_list(value: Any) -> bool:
        return isinstance(value, list) and (len(value) > 0 or not required)

    items = (
        top.take(key, "a list of questions", is_list)
        if required
        else top.take(key, "a list of questions", is_list, [])
    )
    questions: list[Question] = []
    for i, item in enumerate(items or []):
        section = Section(top.source, item, (key, i))
        kind_name = section.choice("kind", tuple(QUESTION_KINDS))
        if kind_name is None:
            continue  # which keys are allowed depends on the kind
        questions.append(QUESTION_KINDS[kind_name].read(section, languages))
        section.finish()
    return questions
