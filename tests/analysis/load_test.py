# SPDX-License-Identifier: MIT
"""The check of an export: a sound one passes, and a bad one hears of every fault at once."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from make_export import Tree, make_tree

from verisim.analysis import ExportError, check_export, load_export
from verisim.analysis.problems import Problem


def ratings_file(root: Path) -> Path:
    return root / "data" / "study-mini_table-ratings_data.csv"


def one(problems: list[Problem]) -> Problem:
    assert len(problems) == 1, "\n".join(map(str, problems))
    return problems[0]


def test_a_sound_export_has_no_problem(sound_export: Path) -> None:
    assert check_export(sound_export) == []


def test_questions_come_with_their_scales_in_the_order_asked(sound_export: Path) -> None:
    questions = load_export(sound_export).questions
    assert list(questions) == ["collision", "rotation", "speed", "fun"]
    assert (questions["speed"].minimum, questions["speed"].maximum) == (1, 7)
    assert (questions["fun"].minimum, questions["fun"].maximum) == (0, 100)


@pytest.mark.parametrize(
    ("table", "column", "value", "words"),
    [
        ("ratings", "value", 8, "off the scale of question collision"),
        ("ratings", "value", 2.5, "off the scale of question collision"),
        ("ratings", "value", "nan", "is not a number"),
        ("ratings", "rt_ms", -5, "is too small"),
        ("ratings", "trial_kind", "tset", "is not an allowed value"),
        ("ratings", "trial_index", "1.5", "is not a whole number"),
        ("ratings", "answered_utc", "2026-03-01 10:00", "is not a UTC time"),
        ("ratings", "participant_id", "", "is empty"),
        ("ratings", "participant_id", "nobody", "leads nowhere"),
        ("ratings", "presentation_id", "nothing", "leads nowhere"),
        ("ratings", "stimulus_sha256", "a" * 64, "differs from sha256"),
        ("ratings", "source", "lab", "differs from source"),
        ("participants", "state", "gone", "is not an allowed value"),
        ("exclusions", "flagged", "yes", "is not a flag"),
        ("engine", "cpu_s_per_sim_s_q1", 99, "cost figures are not in order"),
        ("stimuli", "reference", "missing", "leads nowhere"),
        ("comments", "stimulus", "missing", "leads nowhere"),
    ],
)
def test_a_bad_cell_is_named_with_file_row_column_and_value(
    tmp_path: Path, table: str, column: str, value: object, words: str
) -> None:
    tree = make_tree(2)
    tree.tables[table][0][column] = value
    problem = next(p for p in check_export(tree.write(tmp_path / "export")) if words in p.message)
    assert problem.file == f"data/study-mini_table-{table}_data.csv"
    assert problem.row == 2
    assert problem.hint
    if "order" not in words:
        assert (problem.column, problem.value) == (column, str(value))


def test_every_problem_is_told_at_once(tmp_path: Path) -> None:
    tree = make_tree(2)
    tree.tables["ratings"][0]["value"] = 9
    tree.tables["ratings"][3]["rt_ms"] = "fast"
    tree.tables["participants"][1]["state"] = "gone"
    tree.tables["engine"][0]["stimulus"] = "other"
    tree.description["@type"] = "Thing"
    root = tree.write(tmp_path / "export")
    (root / "data" / "study-mini_table-events_data.csv").unlink()
    with pytest.raises(ExportError) as caught:
        load_export(root)
    text = str(caught.value)
    for words in (
        "off the scale",
        ":5: column rt_ms: is not a number (found 'fast')",
        "(found 'gone')",
        "no such stimulus in table stimuli (found 'other')",
        "is not Dataset (found 'Thing')",
        "study-NAME_table-events_data.csv: is missing",
        "study-mini_table-events_data.csv is listed but missing",
    ):
        assert words in text
    assert len(caught.value.problems) == 7


def repeat_row(tree: Tree) -> None:
    tree.tables["ratings"].append(dict(tree.tables["ratings"][0]))


def undescribed_column(tree: Tree) -> None:
    tree.description["variableMeasured"] = [
        item for item in tree.description["variableMeasured"] if item["name"] != "rt_ms"
    ]


def range_in_codebook(tree: Tree) -> None:
    for item in tree.description["variableMeasured"]:
        if item["name"] == "rt_ms":
            item["maxValue"] = 910
    tree.tables["ratings"] = tree.tables["ratings"][:4]
    tree.tables["ratings"][0]["rt_ms"] = 911
    for row in tree.tables["ratings"][1:]:
        row["rt_ms"] = 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (repeat_row, "repeats line 2"),
        (undescribed_column, "is not in the codebook"),
        (range_in_codebook, "is too large"),
    ],
)
def test_rules_between_rows_and_codebook_hold(
    tmp_path: Path, change: Callable[[Tree], None], words: str
) -> None:
    tree = make_tree(1)
    change(tree)
    problems = check_export(tree.write(tmp_path / "export"))
    assert problems
    assert all(words in problem.message for problem in problems)


def test_a_changed_file_is_found_by_its_checksum(tmp_path: Path) -> None:
    root = make_tree(1).write(tmp_path / "export")
    path = ratings_file(root)
    path.write_text(path.read_text().replace(",900,", ",901,", 1), newline="")
    problem = one(check_export(root))
    assert problem.file == "sha256.txt"
    assert "has changed since the export" in problem.message


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda data: data.replace(b"\n", b"\r\n", 1), "CR LF"),
        (lambda data: b"\xef\xbb\xbf" + data, "byte-order mark"),
        (lambda data: data + b"\xff", "is not UTF-8"),
        (lambda data: data + b"a,b\n", "has 2 cells"),
        (lambda data: data + b'"open', "is not CSV"),
        (lambda data: data.replace(b"rt_ms", b"rt", 1), "is missing"),
        (lambda data: data[:0], "is missing"),
    ],
)
def test_a_broken_table_is_named(
    tmp_path: Path, spoil: Callable[[bytes], bytes], words: str
) -> None:
    root = make_tree(1).write(tmp_path / "export")
    path = ratings_file(root)
    path.write_bytes(spoil(path.read_bytes()))
    assert any(
        words in problem.message and problem.file == f"data/{path.name}"
        for problem in check_export(root)
    )


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("notes.csv", "not the name of an export table"),
        ("study-other_table-ratings_data.csv", "second"),
    ],
)
def test_files_that_do_not_belong_are_named(tmp_path: Path, name: str, words: str) -> None:
    root = make_tree(1).write(tmp_path / "export")
    (root / "data" / name).write_text("a\n")
    assert words in one(check_export(root)).message


def test_a_description_that_is_not_json_is_named(tmp_path: Path) -> None:
    root = make_tree(1).write(tmp_path / "export")
    (root / "dataset_description.json").write_text("{")
    assert any("is not JSON" in problem.message for problem in check_export(root))


def test_a_missing_folder_is_one_problem(tmp_path: Path) -> None:
    assert "no such folder" in one(check_export(tmp_path / "nowhere")).message


def test_bare_names_describe_columns_too(tmp_path: Path) -> None:
    tree = make_tree(1)
    tree.description["variableMeasured"] = [
        item["name"] for item in tree.description["variableMeasured"]
    ]
    root = tree.write(tmp_path / "export")
    assert check_export(root) == []
    assert json.loads((root / "dataset_description.json").read_text())["name"] == "mini"
