# SPDX-License-Identifier: MIT
"""When a question is asked: always, never, at random, or after certain answers to another one."""

from __future__ import annotations

import random
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from verisim.study.server.questions.answer import Answer
from verisim.study.server.yaml_source import MISSING, Section

_CONDITION = re.compile(
    r"^\s*([a-z][a-z0-9_]{0,39})(?:\.([a-z][a-z0-9_]{0,39}))?\s*(<=|>=|==|!=|<|>)\s*(\S.*?)\s*$"
)
ALLOWED = "always | never | {if: KEY <= 3} | {random: 0.15} | {if: KEY <= 3, or_random: 0.15}"


@dataclass(frozen=True)
class Condition:
    """Holds while `question` (its `item`) is answered and the answer compares so with `value`."""

    question: str
    item: str
    op: str
    value: float | str

    def holds(self, answers: Mapping[tuple[str, str], Answer]) -> bool:
        """answers: by question and item; an open question makes the condition false."""
        answer = answers.get((self.question, self.item))
        if answer is None:
            return False
        if isinstance(self.value, str):
            same = answer.value_text == self.value
            return same if self.op == "==" else self.op == "!=" and not same
        return answer.value is not None and _compare(answer.value, self.op, self.value)

    def page_fields(self) -> dict[str, Any]:
        return {"question": self.question, "item": self.item, "op": self.op, "value": self.value}


def _compare(left: float, op: str, right: float) -> bool:
    return {
        "<=": left <= right,
        "<": left < right,
        ">=": left >= right,
        ">": left > right,
        "==": left == right,
        "!=": left != right,
    }[op]


@dataclass(frozen=True)
class Ask:
    """A rule: a share of trials drawn at random, and a condition that holds for the others."""

    share: float = 1.0  # of the trials in which it is asked whatever was answered
    condition: Condition | None = None

    def draw(self, seed: str) -> tuple[bool, Condition | None]:
        """Returns (may be asked, under which condition) for one trial; the seed decides."""
        if self.share >= 1 or random.Random(seed).random() < self.share:
            return True, None
        return self.condition is not None, self.condition


def read_ask(section: Section) -> Ask:
    """Takes the key `ask`; absent: always."""
    value = section.take("ask", ALLOWED, lambda v: isinstance(v, str | dict), "always")
    if isinstance(value, dict):
        rule = Section(section.source, value, (*section.at, "ask"))
        condition = _read_condition(rule) if rule.has("if") else None
        name = "or_random" if rule.has("if") else "random"
        share = rule.number(name, 0, 1, 0.0 if rule.has("if") else MISSING)
        rule.finish()
        return Ask(share or 0.0, condition)
    if value not in ("always", "never", None):
        section.complain("ask", f"{value!r} is not allowed; allowed: {ALLOWED}", "change the value")
    return Ask(0.0) if value == "never" else Ask()


def _read_condition(rule: Section) -> Condition | None:
    text = rule.text("if", max_chars=120)
    found = _CONDITION.match(text) if isinstance(text, str) else None
    if found is None:
        if text is not None:
            rule.complain("if", f"{text!r} is no condition", "write e.g. `if: realism <= 3`")
        return None
    question, item, op, raw = found.groups()
    try:
        value: float | str = float(raw)
    except ValueError:
        value = raw
        if op not in ("==", "!="):
            rule.complain("if", f"{raw!r} is a word; it can only be compared by == or !=")
    return Condition(question, item or "", op, value)
