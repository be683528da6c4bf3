# SPDX-License-Identifier: MIT
"""The export: every answer exactly once, every column explained, the same bytes each time."""

from __future__ import annotations

import csv
import hashlib
import json
import shutil
from collections import Counter
from pathlib import Path

import pytest
from study_tools import Person, Server, new_id, presentation, response, trial_body

from verisim.study.export import export
from verisim.study.export.layout import TABLES
from verisim.study.problems import StudyError


def read_table(tree: Path, table: str) -> list[dict[str, str]]:
    path = tree / "data" / f"study-mini_table-{table}_data.csv"
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def tree_bytes(tree: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(tree)): path.read_bytes()
        for path in sorted(tree.rglob("*"))
        if path.is_file()
    }


@pytest.fixture(scope="module")
def rated(server: Server) -> Server:
    """Two complete participants, one who stops after a broken-off showing, one who declines."""
    for _ in range(2):
        Person.ready(server).finish()
    quitter = Person.ready(server, source="pilot")
    quitter.answer_next()
    answers = [response("realism", 2), response("speed", 1), response("fun", 0.25)]
    answers.append(response("note", None, '=cmd|" /C calc"!A0\nsecond, line'))
    quitter.post("trials", **trial_body(quitter.trial()["trial_id"], responses=answers))
    quitter.post(
        "presentations",
        submission_id=new_id(),
        trial_id=quitter.trial()["trial_id"],
        presentation=presentation(completed=False, ended_ms=None),
    )
    event = {"seq": 4, "presentation_id": new_id(), "kind": "hidden", "t_ms": 1.5, "detail": None}
    quitter.post("events", submission_id=new_id(), events=[event])
    Person.arrive(server).agree(agreed=False)
    return server


@pytest.fixture(scope="module")
def tree(rated: Server, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("export") / "tree"
    export(rated.db, out)
    return out


def test_every_answer_is_exported_exactly_once(rated: Server, tree: Path) -> None:
    stored = rated.query(
        "SELECT presentation_id, key, value FROM response JOIN question USING (question_id)"
    )
    exported = [
        (row["presentation_id"], row["question"], float(row["value"]))
        for row in read_table(tree, "ratings")
    ]
    assert len(stored) == (8 + 8 + 2) * 3
    assert Counter(exported) == Counter(stored)
    notes = rated.query("SELECT presentation_id FROM comment")
    exported_notes = [(row["presentation_id"],) for row in read_table(tree, "comments")]
    assert len(notes) == 18 and Counter(exported_notes) == Counter(notes)


def test_what_was_shown_is_exported_apart_from_what_was_answered(tree: Path) -> None:
    shown = read_table(tree, "presentations")
    assert Counter(row["completed"] for row in shown) == {"1": 18, "0": 1}
    answered = {row["presentation_id"] for row in read_table(tree, "ratings")}
    assert {row["presentation_id"] for row in shown if row["completed"] == "1"} == answered


def test_participants_carry_source_state_and_order(tree: Path) -> None:
    people = read_table(tree, "participants")
    assert Counter((row["source"], row["state"]) for row in people) == {
        ("lab", "completed"): 2,
        ("pilot", "active"): 1,
        ("lab", "declined"): 1,
    }
    quitter = next(row for row in people if row["source"] == "pilot")
    assert (quitter["num_trials_planned"], quitter["num_trials_answered"]) == ("8", "2")
    declined = next(row for row in people if row["state"] == "declined")
    assert declined["consented_utc"] == "" and declined["consent_version"] == "3"


def test_the_codebook_lists_every_column_of_every_table(tree: Path) -> None:
    document = json.loads((tree / "dataset_description.json").read_text())
    assert document["@type"] == "Dataset" and document["name"] == "mini"
    listed = {entry["name"]: entry for entry in document["variableMeasured"]}
    used: set[str] = set()
    for table in TABLES:
        path = tree / "data" / f"study-mini_table-{table}_data.csv"
        columns = path.read_text().splitlines()[0].split(",")
        assert "source" in columns
        used.update(columns)
        for row in read_table(tree, table):
            for name, cell in row.items():
                levels = listed[name].get("levels")
                assert not cell or levels is None or cell in levels, (table, name, cell)
    assert used == set(listed)
    assert all(entry["description"] for entry in listed.values())
    assert "factor_stiffness" in listed
    speed = document["questions"][1]
    assert (speed["min"], speed["max"], speed["points"]) == (1, 5, 5)
    assert speed["meaning"]["en"] == "1 = too slow, 3 = right, 5 = too fast"


def test_the_engine_table_joins_physics_and_cost(tree: Path) -> None:
    engine = {row["stimulus"]: row for row in read_table(tree, "engine")}
    low = engine["drop__stiffness-low__s1"]
    assert low["max_penetration_m"] == "0.03" and low["error_to_reference_m"] == "0.06"
    assert low["cpu_s_per_sim_s_median"] == "0.5" and low["cost_machine"] == "m1"
    assert engine["drop__stiffness-high__s1"]["error_to_reference_m"] == ""


def test_cost_cells_are_empty_where_no_cost_was_measured(rated: Server, tmp_path: Path) -> None:
    cost = rated.set_dir / "cost.csv"
    aside = tmp_path / "cost.csv"
    shutil.move(cost, aside)
    try:
        export(rated.db, tmp_path / "tree")
    finally:
        shutil.move(aside, cost)
    rows = read_table(tmp_path / "tree", "engine")
    assert len(rows) == 8
    assert {row["cost_machine"] + row["cpu_s_per_sim_s_median"] for row in rows} == {""}


def test_exclusions_flag_and_drop_nobody(tree: Path) -> None:
    rows = read_table(tree, "exclusions")
    assert Counter((row["rule"], row["flagged"]) for row in rows) == {
        ("missed_catch", "1"): 2,  # both answered 4 of 7 to the catch clip, the middle
        ("missed_catch", "0"): 2,
        ("median_rt_below_ms", "0"): 4,
    }
    flagged = {row["participant_id"] for row in rows if row["flagged"] == "1"}
    assert flagged <= {row["participant_id"] for row in read_table(tree, "ratings")}


def test_checksums_cover_every_file(tree: Path) -> None:
    lines = (tree / "sha256.txt").read_text().splitlines()
    listed = {path: digest for digest, path in (line.split("  ", 1) for line in lines)}
    seen = {
        name: hashlib.sha256(content).hexdigest()
        for name, content in tree_bytes(tree).items()
        if name != "sha256.txt"
    }
    assert listed == seen


def test_a_comment_cannot_become_a_formula(tree: Path) -> None:
    notes = [row["comment"] for row in read_table(tree, "comments")]
    assert '\'=cmd|" /C calc"!A0\nsecond, line' in notes


def test_the_same_database_gives_the_same_bytes(rated: Server, tree: Path, tmp_path: Path) -> None:
    export(rated.db, tmp_path / "again")
    assert tree_bytes(tmp_path / "again") == tree_bytes(tree)
    assert all(b"\r" not in content for content in tree_bytes(tree).values())


def test_an_export_is_replaced_only_when_told_so(rated: Server, tmp_path: Path) -> None:
    out = tmp_path / "tree"
    export(rated.db, out)
    with pytest.raises(StudyError, match="holds an export already"):
        export(rated.db, out)
    (out / "README.md").write_text("old")
    export(rated.db, out, force=True)
    assert (out / "README.md").read_text() != "old"
    assert [path.name for path in tmp_path.iterdir()] == ["tree"]


def test_a_folder_that_is_no_export_is_never_replaced(rated: Server, tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("mine")
    with pytest.raises(StudyError, match="is no export"):
        export(rated.db, tmp_path, force=True)
    assert (tmp_path / "thesis.txt").read_text() == "mine"


def test_a_missing_or_foreign_database_is_refused_and_not_created(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match="no such file"):
        export(tmp_path / "none.db", tmp_path / "out")
    (tmp_path / "text.db").write_text("not a database, just a text of some length" * 30)
    with pytest.raises(StudyError, match="not a SQLite database"):
        export(tmp_path / "text.db", tmp_path / "out")
    assert not (tmp_path / "none.db").exists() and not (tmp_path / "out").exists()


def test_a_blind_export_keeps_the_answers_and_hides_the_clips(
    rated: Server, tree: Path, tmp_path: Path
) -> None:
    blind = tmp_path / "blind"
    export(rated.db, blind, blind=True)
    text = b"".join(tree_bytes(blind).values()).decode()
    for stimulus in read_table(tree, "stimuli"):
        assert stimulus["stimulus"] not in text and stimulus["sha256"] not in text
    assert "stiffness_" in text and ",low," not in text and "0.03" not in text
    open_rows, blind_rows = read_table(tree, "ratings"), read_table(blind, "ratings")
    pairs = {(a["stimulus"], b["stimulus"]) for a, b in zip(open_rows, blind_rows, strict=True)}
    assert len(pairs) == 8  # one code per clip
    assert [row["value"] for row in open_rows] == [row["value"] for row in blind_rows]
    references = {row["reference"] for row in read_table(blind, "stimuli")} - {""}
    assert references <= {row["stimulus"] for row in read_table(blind, "stimuli")}


def test_the_analysis_accepts_the_export(tree: Path) -> None:
    from verisim.analysis.load import check_export

    assert check_export(tree) == []
