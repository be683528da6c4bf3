# SPDX-License-Identifier: MIT
"""The table `exclusions`: the study file's rules applied to each participant. Flags only."""

from __future__ import annotations

import itertools
import statistics
from collections import defaultdict
from collections.abc import Callable
from typing import Any

from verisim.study.export.rows import Row, Snapshot

# A rule's value from a participant's answers and showings (None: nothing to judge by), and when
# it flags.
Rule = tuple[Callable[[str, list[Row], list[Row]], float | None], Callable[[float, float], bool]]


def exclusions(
    snapshot: Snapshot, people: list[Row], ratings: list[Row], shown: list[Row]
) -> list[Row]:
    """Returns one row per participant and rule; value is empty where nothing was answered."""
    answers_of, shown_of = by_person(ratings), by_person(shown)
    primary = snapshot.config["analysis"]["primary"]
    rows: list[Row] = []
    for person in people:
        who = person["participant_id"]
        for name, limit in sorted(snapshot.config["exclude"].items()):
            if limit is None:
                continue
            measure, flags = RULES[name]
            value = measure(primary, answers_of[who], shown_of[who])
            rows.append(
                {
                    "participant_id": who,
                    "source": person["source"],
                    "rule": name,
                    "value": value,
                    "limit": limit,
                    "flagged": int(value is not None and flags(value, limit)),
                }
            )
    return rows


def by_person(rows: list[Row]) -> dict[str, list[Row]]:
    grouped: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        grouped[row["participant_id"]].append(row)
    return grouped


def count_missed(primary: str, answers: list[Row], shown: list[Row]) -> float | None:
    """Catch trials whose answer is not the expected one."""
    del primary, shown
    caught = [a for a in answers if a["trial_kind"] == "catch" and a["correct"] is not None]
    return float(sum(not answer["correct"] for answer in caught)) if caught else None


def median_rt_ms(primary: str, answers: list[Row], shown: list[Row]) -> float | None:
    del primary, shown
    times = [answer["rt_ms"] for answer in answers if answer["trial_kind"] == "test"]
    return float(statistics.median(times)) if times else None


def longest_equal_run(primary: str, answers: list[Row], shown: list[Row]) -> float | None:
    """The longest run of one answer to the primary question, practice left out."""
    del shown
    values: list[Any] = [
        (answer["value"], answer["value_text"])
        for answer in answers
        if answer["question"] == primary and answer["trial_kind"] != "practice"
    ]
    runs = [len(list(group)) for _, group in itertools.groupby(values)]
    return float(max(runs)) if runs else None


def dropped_share(primary: str, answers: list[Row], shown: list[Row]) -> float | None:
    del primary, answers
    tests = [row for row in shown if row["trial_kind"] == "test" and row["frames_total"]]
    total = sum(row["frames_total"] for row in tests)
    return sum(row["frames_dropped"] or 0 for row in tests) / total if total else None


def hidden_ms(primary: str, answers: list[Row], shown: list[Row]) -> float | None:
    del primary, answers
    return float(sum(row["hidden_ms"] for row in shown)) if shown else None


RULES: dict[str, Rule] = {
    "missed_catch": (count_missed, lambda value, limit: value >= limit),
    "median_rt_below_ms": (median_rt_ms, lambda value, limit: value < limit),
    "equal_answers_run": (longest_equal_run, lambda value, limit: value >= limit),
    "frames_dropped_share": (dropped_share, lambda value, limit: value > limit),
    "hidden_ms": (hidden_ms, lambda value, limit: value > limit),
}
