# SPDX-License-Identifier: MIT
"""The words beside the tables: dataset_description.json with the codebook, and README.md."""

from __future__ import annotations

import json
from typing import Any

from verisim.study.export.columns import describe
from verisim.study.export.layout import TABLES, column_names
from verisim.study.export.rows import Row, Snapshot

SOURCE_WORDS = {"simulated": "scripted raters (simulated, not people)"}


def dataset_description(
    snapshot: Snapshot, questions: list[Row], counts: dict[str, int], *, blind: bool
) -> str:
    """Returns the Psych-DS description: every column of every table, and every question."""
    tables_of: dict[str, list[str]] = {}
    for table in TABLES:
        for name in column_names(table, snapshot.factor_names):
            tables_of.setdefault(name, []).append(table)
    config = snapshot.config
    asked = {q["key"]: q for q in [*config["questions"], *config.get("end_questions", [])]}
    described = [describe_question(row, asked[row["key"]]) for row in questions]
    variables = [describe_variable(name, where, described) for name, where in tables_of.items()]
    document = {
        "@context": "https://schema.org/",
        "@type": "Dataset",
        "name": snapshot.name,
        "description": f"{snapshot.study['title']} Ratings of simulated motion: "
        f"{describe_sources(counts)}.",
        "schemaVersion": "Psych-DS 0.4.0",
        "variableMeasured": variables,
        "questions": described,
        "study": {
            "schema": 1,
            "blind": blind,
            "num_participants": counts,
            "mode": snapshot.study["mode"],
            "set": snapshot.study["set_name"],
            "set_sha256": snapshot.study["set_sha256"],
            "config_sha256": snapshot.study["config_sha256"],
            "trial": snapshot.config["trial"],
            "order": snapshot.config["order"],
            "exclude": snapshot.config["exclude"],
            "analysis": snapshot.config["analysis"],
        },
    }
    return json.dumps(document, ensure_ascii=False, indent=2) + "\n"


def describe_sources(counts: dict[str, int]) -> str:
    """{'lab': 3, 'simulated': 12} → 'participants: 3 lab, 12 scripted raters (simulated, …)'."""
    parts = [f"{num} {SOURCE_WORDS.get(source, source)}" for source, num in counts.items()]
    return "participants: " + (", ".join(parts) or "none yet")


def describe_question(row: Row, asked: dict[str, Any]) -> dict[str, Any]:
    """Returns a question as the study file asks it (prompt, ends, points …), with its scale."""
    return {
        **asked,
        "meaning": json.loads(row["meaning_json"]),
        "place": row["place"],
        "min": row["scale_min"],
        "max": row["scale_max"],
        "step": row["scale_step"],
    }


def describe_variable(
    name: str, tables: list[str], questions: list[dict[str, Any]]
) -> dict[str, Any]:
    column = describe(name)
    levels = dict(column.levels)
    entry: dict[str, Any] = {
        "@type": "PropertyValue",
        "name": name,
        "description": column.description,
        "tables": tables,
    }
    if column.unit:
        entry["unitText"] = column.unit
    if name == "question":
        levels = {q["key"]: first_of(q["prompt"]) for q in questions}
    if name in ("value", "comment"):
        numeric = name == "value"
        entry["meaning"] = {
            q["key"]: first_of(q["meaning"])
            for q in questions
            if (q["kind"] != "comment") == numeric
        }
    if levels:
        entry["levels"] = levels
    return entry


def first_of(by_language: dict[str, str]) -> str:
    return next(iter(by_language.values()))


def readme(snapshot: Snapshot, questions: list[Row], counts: dict[str, int], *, blind: bool) -> str:
    """Returns the export's own page: what lies here and how to read it."""
    asked = "\n".join(
        f"* `{row['key']}` ({row['kind']}): {first_of(json.loads(row['prompt_json']))} "
        f"{first_of(json.loads(row['meaning_json']))}"
        for row in questions
    )
    tables = "\n".join(f"* `{file_name(snapshot.name, table)}`" for table in TABLES)
    hidden = (
        "\nThis is a **blind** export: clips, methods and levels carry codes, and what would give "
        "them away is empty.\n"
        if blind
        else ""
    )
    return f"""# {snapshot.study["title"]}

Data of the study `{snapshot.name}`; {describe_sources(counts)}. Written by Verisim.
{hidden}
`dataset_description.json` explains every column (unit, meaning, levels). `sha256.txt` holds the
checksum of every file: `sha256sum -c sha256.txt`.

## Questions

{asked}

## Tables (folder `data`)

{tables}

UTF-8, comma, one header line, empty = missing, times in UTC (`_utc`), durations in `_ms` or `_s`.
The column `source` says who a row comes from; `simulated` rows are scripted raters, not people.
Flagged participants (`exclusions`) are in all tables; leaving them out is the analysis's decision.
A text that begins with = + - or @ has an apostrophe before it, so that no program runs it as a
formula.
Comments are kept in a table of their own because free text can hold personal data: read them before
passing them on.
"""


def file_name(study: str, table: str) -> str:
    return f"data/study-{study}_table-{table}_data.csv"
