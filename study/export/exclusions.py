# SPDX-License-Identifier: MIT
"""The table `exclusions`: the study file's rules applied to each participant. Flags only."""

from __future__ import annotations

import statistics
from collections import defaultdict

from verisim.study.export.rows import Row, Snapshot, questions


def exclusions(snapshot: Snapshot, people: list[Row], ratings: list[Row]) -> list[Row]:
    """Returns one row per participant and rule; value is empty where nothing was answered."""
    by_person: dict[str, list[Row]] = defaultdict(list)
    for rating in ratings:
        by_person[rating["participant_id"]].append(rating)
    rows: list[Row] = []
    for person in people:
        answers = by_person[person["participant_id"]]
        for rule, limit in sorted(snapshot.config["exclude"].items()):
            if limit is None:
                continue
            if rule == "missed_catch":
                value = count_missed(snapshot, answers)
                flagged = value is not None and value >= limit
            else:
                value = median_rt_ms(answers)
                flagged = value is not None and value < limit
            rows.append(
                {
                    "participant_id": person["participant_id"],
                    "source": person["source"],
                    "rule": rule,
                    "value": value,
                    "limit": limit,
                    "flagged": int(flagged),
                }
            )
    return rows


def count_missed(snapshot: Snapshot, answers: list[Row]) -> float | None:
    """Catch clips whose answer to the primary question is not below the middle of its scale."""
    primary = snapshot.config["analysis"]["primary"]
    caught = [a for a in answers if a["trial_kind"] == "catch" and a["question"] == primary]
    if not caught:
        return None
    middle = scale_middle(snapshot, primary)
    return float(sum(answer["value"] >= middle for answer in caught))


def scale_middle(snapshot: Snapshot, question: str) -> float:
    row = next(row for row in questions(snapshot) if row["key"] == question)
    return float((row["scale_min"] + row["scale_max"]) / 2)


def median_rt_ms(answers: list[Row]) -> float | None:
    times = [answer["rt_ms"] for answer in answers if answer["trial_kind"] == "test"]
    return float(statistics.median(times)) if times else None
