# SPDX-License-Identifier: MIT
"""The whole analysis: what is written, the same bytes each time, and what it refuses."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import pytest
from make_export import Tree, make_tree

from verisim.analysis import SECTIONS, AnalysisError, analyse

COST_COLUMNS = [f"cpu_s_per_sim_s_{end}" for end in ("median", "min", "q1", "q3")]


def files(root: Path) -> dict[str, bytes]:
    return {
        path.relative_to(root).as_posix(): path.read_bytes()
        for path in sorted(root.rglob("*"))
        if path.is_file()
    }


def read(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_the_report_is_one_small_file_without_links_outside(analysed: Path) -> None:
    page = (analysed / "report.html").read_text()
    assert len(page.encode()) < 1_000_000  # measured 380 KB
    addresses = set(re.findall(r"https?://[^\"' )<]+", page))
    assert addresses <= {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"}
    assert not re.search(r"(src|href)=\"(?!#)", page)
    assert not re.search(r"<script|<link|@import|url\((?!#)", page)


def test_every_section_and_table_is_there(analysed: Path) -> None:
    page = (analysed / "report.html").read_text()
    for section in set(SECTIONS) - {"pairs"}:  # pairs: in studies that show two clips at a time
        assert f'<section id="{section}">' in page
    assert {path.stem for path in (analysed / "tables").iterdir()} == {
        "flow", "flags", "scores", "differences", "agreement", "rating_and_cost",
        "rating_and_error", "rank_correlation_cost", "rank_correlation_error", "comments",
        "comment_themes", "comment_words",
    }  # fmt: skip


def test_simulated_stands_in_title_figures_and_tables(analysed: Path) -> None:
    page = (analysed / "report.html").read_text()
    title = re.search(r"<title>(.*?)</title>", page)
    assert title is not None
    assert "simulated" in title[1]
    drawings = re.findall(r"<svg.*?</svg>", page, flags=re.DOTALL)
    assert len(drawings) == 20
    for drawing in drawings:
        assert ">simulated answers</text>" in drawing
    for path in (analysed / "figures").iterdir():
        assert ">simulated answers</text>" in path.read_text()
    for path in (analysed / "tables").iterdir():
        rows = read(path)
        assert rows
        assert {row["source"] for row in rows} == {"simulated"}


def test_the_same_export_gives_the_same_bytes(
    sound_export: Path, analysed: Path, tmp_path: Path
) -> None:
    analyse(sound_export, tmp_path / "again")
    assert files(tmp_path / "again") == files(analysed)


def test_order_of_rows_changes_no_table(analysed: Path, tmp_path: Path) -> None:
    tree = make_tree()
    for rows in tree.tables.values():
        rows.reverse()
    analyse(tree.write(tmp_path / "export"), tmp_path / "out")
    for path in (analysed / "tables").iterdir():
        assert (tmp_path / "out" / "tables" / path.name).read_bytes() == path.read_bytes()


def test_failed_runs_stay_in_the_charts_as_open_markers(analysed: Path) -> None:
    for name in ("cpu-s-per-sim-s-median-collision", "max-penetration-m-collision"):
        figure = (analysed / "figures" / f"{name}.svg").read_text()
        assert figure.count("<title>") == 12
        failed = figure.split("run failed: sank</title>")[1].split("<use")[1]
        assert "fill: #ffffff" in failed.split("/>")[0]
        assert ">failed run</text>" in figure


def test_a_reference_without_distance_is_named(analysed: Path) -> None:
    page = (analysed / "report.html").read_text()
    assert "No figure for distance from the reference run:" in page
    assert "(the reference itself)" in page


def without_cost(tree: Tree) -> None:
    for row in tree.tables["engine"]:
        row |= dict.fromkeys(COST_COLUMNS, "")


def two_machines(tree: Tree) -> None:
    tree.tables["engine"][0]["cost_machine"] = "bench-2"


def blind(tree: Tree) -> None:
    without_cost(tree)
    tree.description["study"]["blind"] = True


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (without_cost, "holds no measured cost"),
        (two_machines, "costs come from 2 machines"),
        (blind, "this is a blind export"),
    ],
)
def test_a_cost_chart_without_comparable_cost_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], change: object, words: str
) -> None:
    tree = make_tree(3)
    assert callable(change)
    change(tree)
    result = analyse(tree.write(tmp_path / "export"), tmp_path / "out", only=["scores", "cost"])
    page = result.report.read_text()
    assert words in page
    assert words in capsys.readouterr().err
    assert not list((tmp_path / "out" / "figures").glob("cpu*"))
    assert not (tmp_path / "out" / "tables" / "rating_and_cost.csv").exists()


def mixed(tmp_path: Path) -> Path:
    tree, people = make_tree(2), make_tree(3, source="lab", seed=2)
    for name, rows in people.tables.items():
        if name in ("stimuli", "engine"):
            continue
        for row in rows:
            for key in ("participant_id", "session_id", "presentation_id"):
                if key in row:
                    row[key] = f"L{row[key]}"
            tree.tables[name].append(row)
    return tree.write(tmp_path / "mixed")


def test_simulated_and_live_answers_are_not_mixed(tmp_path: Path) -> None:
    export = mixed(tmp_path)
    with pytest.raises(AnalysisError, match="mixes simulated answers with live ones"):
        analyse(export, tmp_path / "out")
    assert not (tmp_path / "out").exists()
    for source, count in (("simulated", 2), ("lab", 3), ("live", 3)):
        result = analyse(export, tmp_path / source, source=source, only=["flow"])
        assert result.num_analysed == count
        page = result.report.read_text()
        assert ("simulated" in page) == (source == "simulated")
    for source, words in (("link", "no answers with source 'link'"), ("web", "unknown source")):
        with pytest.raises(AnalysisError, match=words):
            analyse(export, tmp_path / "none", source=source)


def one_rater(tree: Tree) -> None:
    for name, rows in tree.tables.items():
        tree.tables[name] = [row for row in rows if row.get("participant_id", "P001") == "P001"]


def constant(tree: Tree) -> None:
    for row in tree.tables["ratings"]:
        row["value"] = 4


def missing_cells(tree: Tree) -> None:
    tree.tables["ratings"] = tree.tables["ratings"][::3]


def no_comments(tree: Tree) -> None:
    tree.tables["comments"] = []


def nobody(tree: Tree) -> None:
    for name in tree.tables:
        if name not in ("stimuli", "engine"):
            tree.tables[name] = []


def nobody_completed(tree: Tree) -> None:
    for row in tree.tables["participants"]:
        row["state"] = "active"


def no_engine_figures(tree: Tree) -> None:
    kept = ("study", "source", "stimulus", "method")
    tree.tables["engine"] = [{key: row[key] for key in kept} for row in tree.tables["engine"]]


def everyone_flagged(tree: Tree) -> None:
    for row in tree.tables["exclusions"]:
        row["flagged"] = 1


def no_codebook_questions(tree: Tree) -> None:
    del tree.description["questions"]


@pytest.mark.parametrize(
    ("change", "only", "sentence"),
    [
        (one_rater, SECTIONS, "Agreement cannot be computed: only one person answered."),
        (constant, ("scores", "agreement"), "everybody gave the same answer (4) to every clip"),
        (missing_cells, ("scores", "agreement"), "Fewer than two people rated every clip"),
        (no_comments, ("comments",), "No comments on test clips."),
        (nobody, SECTIONS, "Nobody has completed the study"),
        (nobody_completed, SECTIONS, "Nobody has completed the study"),
        (no_engine_figures, ("error",), "No rated clip has an error figure."),
        (everyone_flagged, ("flow", "scores"), "of them flagged</dt><dd>4</dd>"),
        (no_codebook_questions, ("scores", "agreement"), "Single people"),
    ],
)
def test_thin_data_end_in_a_sentence_not_a_crash(
    tmp_path: Path, change: object, only: tuple[str, ...], sentence: str
) -> None:
    tree = make_tree(4)
    assert callable(change)
    change(tree)
    result = analyse(tree.write(tmp_path / "export"), tmp_path / "out", only=only)
    assert sentence in result.report.read_text()


def test_what_people_write_cannot_change_the_page(tmp_path: Path) -> None:
    tree = make_tree(3)
    hostile = '<script>alert("x")</script> & "quoted",\nnext line'
    tree.tables["comments"][0]["comment"] = hostile
    result = analyse(tree.write(tmp_path / "export"), tmp_path / "out", only=["comments"])
    page = result.report.read_text()
    assert "<script" not in page
    assert "&lt;script&gt;" in page
    comments = read(tmp_path / "out" / "tables" / "comments.csv")
    assert hostile in {row["comment"] for row in comments}


def test_only_the_parts_asked_for_are_made(sound_export: Path, tmp_path: Path) -> None:
    result = analyse(sound_export, tmp_path / "out", only=["agreement"])
    page = result.report.read_text()
    assert re.findall(r'<section id="(\w+)">', page) == ["agreement", "method"]
    assert [path.name for path in (tmp_path / "out" / "tables").iterdir()] == ["agreement.csv"]
    with pytest.raises(AnalysisError, match="unknown section: 'agreemnt'"):
        analyse(sound_export, tmp_path / "other", only=["agreemnt"])


def test_nothing_is_overwritten_without_being_told(sound_export: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    analyse(sound_export, out, only=["flow"])
    with pytest.raises(AnalysisError, match="is not empty"):
        analyse(sound_export, out, only=["agreement"])
    analyse(sound_export, out, only=["agreement"], force=True)
    assert [path.name for path in (out / "tables").iterdir()] == ["agreement.csv"]
    other = tmp_path / "other"
    other.mkdir()
    (other / "thesis.txt").write_text("years of work")
    with pytest.raises(AnalysisError, match="holds no earlier analysis"):
        analyse(sound_export, other, force=True)
    assert (other / "thesis.txt").read_text() == "years of work"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["other", "out"]
