# SPDX-License-Identifier: MIT
"""Kinds of question: which answers each takes, and when a question is asked."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import pytest

from verisim.study.problems import StudyError
from verisim.study.server.questions import QUESTION_KINDS, Answer, Question
from verisim.study.server.yaml_source import Section, YamlSource

PROMPT = "key: q, prompt: {en: Why?}"
ENDS = "ends: {en: [low, high]}"
ITEMS = "items: {one: {en: One}, two: {en: Two}}"
KINDS = {
    "rating": f"{PROMPT}, points: 7, {ENDS}",
    "bipolar": f"{PROMPT}, points: 5, {ENDS}, middle: {{en: right}}",
    "slider": f"{PROMPT}, {ENDS}",
    "yes_no": PROMPT,
    "choice": f"{PROMPT}, not_sure: true",
    "category": f"{PROMPT}, options: {{alive: {{en: Alive}}, dead: {{en: Dead}}}}",
    "checklist": f"{PROMPT}, {ITEMS}",
    "fun": "key: q",
    "emotion": f"key: q, {ITEMS}, points: 5",
    "confidence": "key: q",
    "comment": PROMPT,
    "mark": f"{PROMPT}, max_marks: 2",
}


def question(kind: str, more: str = "", languages: tuple[str, ...] = ("en",)) -> Question:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "question.yaml"
        path.write_text(f"{{kind: {kind}, {KINDS[kind]}{more}}}")
        source = YamlSource(path)
        section = Section(source, source.root)
        section.taken.append("kind")
        read = QUESTION_KINDS[kind].read(section, languages)
        section.finish()
        source.raise_problems()
    return read


def test_every_kind_is_tested_here() -> None:
    assert set(KINDS) == set(QUESTION_KINDS)


def number(value: float, item: str = "") -> dict[str, Answer]:
    return {item: Answer(value, None)}


def text(value: str, item: str = "") -> dict[str, Answer]:
    return {item: Answer(None, value)}


KEPT, VIOLATED = Answer(1.0, "kept"), Answer(0.0, "violated")
GOOD: list[tuple[str, dict[str, Answer]]] = [
    ("rating", number(7)),
    ("bipolar", number(3)),
    ("slider", number(99.5)),
    ("yes_no", number(0)),
    ("choice", number(2)),
    ("choice", text("not_sure")),
    ("category", text("dead")),
    ("checklist", {"one": KEPT, "two": Answer(None, "cannot_tell")}),
    ("fun", number(5)),
    ("emotion", {**number(1, "one"), **number(5, "two")}),
    ("confidence", number(4)),
    ("comment", text("fine")),
    ("comment", {}),
    ("mark", {**number(120.5, "m1"), **number(0, "m2")}),
    ("mark", text("none")),
    ("mark", {}),
]
BAD: list[tuple[str, dict[str, Answer], str]] = [
    ("rating", number(0), "whole numbers 1 to 7"),
    ("rating", number(2.5), "whole numbers 1 to 7"),
    ("rating", {}, "needs an answer"),
    ("rating", number(3, "one"), "unknown item"),
    ("bipolar", number(6), "whole numbers 1 to 5"),
    ("slider", number(100.5), "0 to 100"),
    ("slider", text("50"), "takes a number"),
    ("yes_no", number(2), "neither 1 (yes) nor 0 (no)"),
    ("yes_no", {"": Answer(1, "yes")}, "neither"),
    ("choice", number(0), "neither 1 nor 2"),
    ("choice", text("maybe"), "neither 1 nor 2"),
    ("category", text("undead"), "alive, dead"),
    ("category", number(1), "alive, dead"),
    ("checklist", {"one": KEPT}, "two: needs an answer"),
    ("checklist", {"one": Answer(1.0, "violated"), "two": KEPT}, "one: takes 1 with `kept`"),
    ("checklist", {"one": KEPT, "two": KEPT, "three": KEPT}, "unknown item 'three'"),
    ("emotion", {**number(6, "one"), **number(5, "two")}, "one: 6"),
    ("confidence", number(5), "whole numbers 1 to 4"),
    ("comment", text("x" * 201), "201 characters"),
    ("comment", number(1), "takes text"),
    ("mark", number(-1, "m1"), "not a time"),
    ("mark", number(1, "m2"), "without a gap"),
    ("mark", {**text("none"), **number(1, "m1")}, "unknown item ''"),
    ("mark", text("somewhere"), "unknown item ''"),
]


@pytest.mark.parametrize(("kind", "answers"), GOOD)
def test_a_fitting_answer_is_taken(kind: str, answers: dict[str, Answer]) -> None:
    assert question(kind).find_faults(answers) == []


@pytest.mark.parametrize(("kind", "answers", "words"), BAD)
def test_an_impossible_answer_is_refused(kind: str, answers: dict[str, Answer], words: str) -> None:
    faults = question(kind).find_faults(answers)
    assert len(faults) >= 1 and words in "; ".join(faults)


def test_words_of_our_own_exist_in_english_and_german_alone() -> None:
    german = question("fun", languages=("en", "de")).prompt["de"]
    assert "Spaß" in german
    with pytest.raises(StudyError, match="no words of our own in fr"):
        question("fun", languages=("en", "fr"))


@pytest.mark.parametrize(
    ("rule", "share", "condition"),
    [
        ("", 1.0, None),
        (", ask: always", 1.0, None),
        (", ask: never", 0.0, None),
        (", ask: {random: 0.25}", 0.25, None),
        (", ask: {if: realism <= 3}", 0.0, ("realism", "", "<=", 3.0)),
        (", ask: {if: laws.gravity == violated, or_random: 0.1}", 0.1,
         ("laws", "gravity", "==", "violated")),
    ],
)  # fmt: skip
def test_ask_rules_are_read(rule: str, share: float, condition: Any) -> None:
    ask = question("rating", rule).ask
    assert ask.share == share
    found = ask.condition
    fields = found and (found.question, found.item, found.op, found.value)
    assert fields == condition


@pytest.mark.parametrize(
    ("rule", "words"),
    [
        (", ask: sometimes", "is not allowed"),
        (", ask: {if: realism ~ 3}", "is no condition"),
        (", ask: {if: which <= not_sure}", "only be compared by == or !="),
        (", ask: {}", "random: missing"),
        (", ask: {random: 2}", "a number from 0 to 1"),
    ],
)
def test_ask_rules_that_mean_nothing_are_refused(rule: str, words: str) -> None:
    with pytest.raises(StudyError, match=words):
        question("rating", rule)


def test_a_random_rule_asks_its_share_and_always_the_same_for_a_seed() -> None:
    ask = question("rating", ", ask: {random: 0.25}").ask
    drawn = [ask.draw(f"s:{i}:q")[0] for i in range(2000)]
    assert 0.22 < sum(drawn) / 2000 < 0.28  # measured 0.249
    assert drawn == [ask.draw(f"s:{i}:q")[0] for i in range(2000)]


def test_a_condition_waits_for_the_other_answer() -> None:
    condition = question("rating", ", ask: {if: realism <= 3}").ask.condition
    assert condition is not None
    assert not condition.holds({})
    assert condition.holds({("realism", ""): Answer(3, None)})
    assert not condition.holds({("realism", ""): Answer(4, None)})
    words = question("rating", ", ask: {if: which != not_sure}").ask.condition
    assert words is not None
    assert words.holds({("which", ""): Answer(2, None)})
    assert not words.holds({("which", ""): Answer(None, "not_sure")})
