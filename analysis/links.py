# SPDX-License-Identifier: MIT
"""Checks what holds between rows: unique keys, references that lead somewhere, facts told twice."""

from __future__ import annotations

from verisim.analysis.cells import RawTable, parse_number
from verisim.analysis.columns import TABLES
from verisim.analysis.problems import Problem


def check_links(tables: dict[str, RawTable]) -> list[Problem]:
    """Broken keys and references across all tables."""
    problems: list[Problem] = []
    for name, raw in tables.items():
        problems += _repeated_keys(name, raw)
        problems += _dangling(name, raw, tables)
        if TABLES[name].of_people and name != "participants":
            people, key = tables.get("participants"), "participant_id"
            problems += _told_twice(raw, key, "source", people, key, "source")
        for clip, sha in (("stimulus", "stimulus_sha256"), ("stimulus_b", "stimulus_b_sha256")):
            problems += _told_twice(raw, clip, sha, tables.get("stimuli"), "stimulus", "sha256")
    problems += _unordered_quartiles(tables.get("engine"))
    return problems


def _repeated_keys(name: str, raw: RawTable) -> list[Problem]:
    key = TABLES[name].key
    if not key or not set(key) <= set(raw.header):
        return []
    first: dict[tuple[str, ...], int] = {}
    problems = []
    for line, values in zip(raw.lines, zip(*map(raw.column, key), strict=True), strict=True):
        if values in first:
            message = f"repeats line {first[values]}"
            hint = "two exports may have been pasted together; export again"
            problems.append(
                Problem(raw.file, line, ", ".join(key), ", ".join(values), message, "one row", hint)
            )
        first.setdefault(values, line)
    return problems


def _dangling(name: str, raw: RawTable, tables: dict[str, RawTable]) -> list[Problem]:
    refers = dict(TABLES[name].refers)
    if "stimulus_b" in raw.header:
        refers["stimulus_b"] = ("stimuli", "stimulus")
    problems = []
    for column, (target, target_column) in refers.items():
        if target not in tables or target_column not in tables[target].header:
            continue
        known = set(tables[target].column(target_column))
        for line, value in zip(raw.lines, raw.column(column), strict=False):
            if value and value not in known:
                message = f"leads nowhere: no such {target_column} in table {target}"
                hint = "rows were removed or tables come from different exports; export again"
                allowed = f"a {target_column} of table {target}"
                problems.append(Problem(raw.file, line, column, value, message, allowed, hint))
    return problems


def _told_twice(
    raw: RawTable, key: str, fact: str, other: RawTable | None, other_key: str, other_fact: str
) -> list[Problem]:
    """Rows whose `fact` differs from what the row they point to says."""
    if other is None or not {key, fact} <= set(raw.header):
        return []
    said = dict(zip(other.column(other_key), other.column(other_fact), strict=False))
    problems = []
    for line, at, value in zip(raw.lines, raw.column(key), raw.column(fact), strict=True):
        if value and at in said and value != said[at]:
            message = f"differs from {other_fact} of {at} in {other.file}"
            hint = "the clip or the participant is not the one recorded; export again"
            problems.append(Problem(raw.file, line, fact, value, message, said[at], hint))
    return problems


def _unordered_quartiles(engine: RawTable | None) -> list[Problem]:
    names = ["cpu_s_per_sim_s_" + end for end in ("min", "q1", "median", "q3")]
    if engine is None or not set(names) <= set(engine.header):
        return []
    problems = []
    for line, row in zip(engine.lines, zip(*map(engine.column, names), strict=True), strict=True):
        numbers = [parse_number(cell) for cell in row]
        known = [number for number in numbers if number is not None]
        if known != sorted(known):
            message = "cost figures are not in order"
            hint = "measure again with `verisim stimuli cost`"
            problems.append(
                Problem(
                    engine.file, line, names[2], row[2], message, "min <= q1 <= median <= q3", hint
                )
            )
    return problems
