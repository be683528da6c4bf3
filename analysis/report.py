# SPDX-License-Identifier: MIT
"""Runs the analysis of one export and writes its tables, figures, report and run log."""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

from verisim.analysis import page, runlog
from verisim.analysis.agreement import METRICS, Agreement, Estimate, agreement, verdict
from verisim.analysis.comments import comment_rows, theme_counts, word_counts
from verisim.analysis.exclude import (
    Cohort,
    Step,
    choose_cohort,
    flag_table,
    participant_flow,
    presentation_flow,
)
from verisim.analysis.figures import Drawing, draw_scores, draw_tradeoff
from verisim.analysis.load import Export, load_export
from verisim.analysis.pairs import ALL_LAYOUTS, CHOICE, PairFindings, analyse_pairs, as_share
from verisim.analysis.problems import AnalysisError
from verisim.analysis.scores import (
    SCORE_COLUMNS,
    clip_scores,
    rated_cells,
    reference_differences,
    repeat_differences,
)
from verisim.analysis.source import choose_source
from verisim.analysis.tradeoff import (
    COST_MEASURE,
    ERROR_MEASURES,
    Measure,
    join_engine,
    rank_correlation,
    why_no_cost,
)

SECTIONS = ("flow", "scores", "agreement", "pairs", "cost", "error", "comments")
LOG_FILE = "run_log.json"


@dataclass
class Findings:
    """Everything the report shows; tables are written as CSV, the rest only on the page."""

    export: Export
    source: str
    cohort: Cohort
    sections: tuple[str, ...]
    tables: dict[str, pd.DataFrame] = field(default_factory=dict)
    drawings: dict[str, list[Drawing]] = field(default_factory=dict)
    people_flow: list[Step] = field(default_factory=list)
    clip_flow: list[Step] = field(default_factory=list)
    verdicts: list[tuple[str, str]] = field(default_factory=list)
    refused_cost: str = ""
    messages: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class AnalysisResult:
    """What was written. messages: sentences for the reader, also printed to stderr."""

    out_dir: Path
    report: Path
    source: str
    num_analysed: int
    messages: tuple[str, ...]

    def __str__(self) -> str:
        return str(self.report)


def analyse(
    export_dir: Path | str,
    out_dir: Path | str,
    *,
    source: str | None = None,
    only: Iterable[str] | None = None,
    force: bool = False,
) -> AnalysisResult:
    """Analyse the export tree and write tables/, figures/, report.html and run_log.json.

    source: whose answers, see source.choose_source. only: some of SECTIONS, default all.
    force: replace an earlier analysis in out_dir; anything else there is never touched.
    Raises ExportError for a broken export and AnalysisError for a request that cannot be met;
    out_dir is then left as it was.
    """
    out = Path(out_dir)
    sections = _choose_sections(only)
    _refuse_to_overwrite(out, force)
    export, named = choose_source(load_export(export_dir), source)
    if only is None:
        sections = tuple(name for name in sections if _has_answers_for(name, export))
    findings = find(export, named, sections)
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=f".{out.name}.", dir=out.parent) as scratch:
        fresh = Path(scratch) / "fresh"
        _write(findings, fresh)
        if out.exists():
            out.rename(Path(scratch) / "old")
        fresh.rename(out)
    for message in findings.messages:
        print(message, file=sys.stderr)
    return AnalysisResult(
        out, out / "report.html", named, len(findings.cohort.analysed), tuple(findings.messages)
    )


def find(export: Export, source: str, sections: tuple[str, ...]) -> Findings:
    """Compute every section asked for; nothing is written."""
    cohort = choose_cohort(export)
    found = Findings(export, source, cohort, sections)
    cells = {name: rated_cells(export, people) for name, people in cohort.sets().items()}
    scores = [clip_scores(rows, name) for name, rows in cells.items() if len(rows)]
    all_scores = pd.concat(scores) if scores else pd.DataFrame(columns=list(SCORE_COLUMNS))
    if not cohort.analysed:
        found.messages.append(
            "Nobody has completed the study and answered a test clip yet, so there is nothing to "
            "score; the flow of participants is all this report can show."
        )
    if "flow" in sections:
        _find_flow(found)
    if "scores" in sections:
        _find_scores(found, all_scores, cells)
    if "agreement" in sections:
        _find_agreement(found, cells)
    pairs = analyse_pairs(export, cohort.sets())
    if "pairs" in sections:
        _find_pairs(found, pairs)
    charted = pd.concat([all_scores, pairs.found[pairs.found["layout"] == ALL_LAYOUTS]])
    points = join_engine(export, charted[charted["participants"] == "all"])
    if "cost" in sections:
        found.refused_cost = why_no_cost(export)
        if found.refused_cost:
            found.messages.append(found.refused_cost)
        else:
            _find_tradeoff(found, "cost", points, (COST_MEASURE,))
    if "error" in sections:
        _find_tradeoff(found, "error", points, ERROR_MEASURES)
    if "comments" in sections:
        _find_comments(found)
    return found


def _find_flow(found: Findings) -> None:
    found.people_flow = participant_flow(found.export, found.cohort)
    found.clip_flow = presentation_flow(found.export, found.cohort)
    steps = [("participants", step) for step in found.people_flow]
    steps += [("presentations", step) for step in found.clip_flow]
    found.tables["flow"] = pd.DataFrame(
        [[of, step.name, step.count, step.lost] for of, step in steps],
        columns=["of", "step", "count", "not_counted"],
    )
    found.tables["flags"] = flag_table(found.export, found.cohort)


def _find_scores(found: Findings, scores: pd.DataFrame, cells: dict[str, pd.DataFrame]) -> None:
    stimuli = found.export.tables["stimuli"]
    found.tables["scores"] = scores
    found.tables["differences"] = pd.concat(
        [reference_differences(rows, stimuli, name) for name, rows in cells.items()]
    )
    found.tables["repeats"] = repeat_differences(found.export, found.cohort.analysed)
    found.drawings["scores"] = [
        draw_scores(
            question,
            scores[scores["question"] == key],
            cells["all"][cells["all"]["question"] == key],
            found.source,
        )
        for key, question in found.export.questions.items()
        if (cells["all"]["question"] == key).any()
    ]


def _find_agreement(found: Findings, cells: dict[str, pd.DataFrame]) -> None:
    rows = []
    for people, ratings in cells.items():
        for key, question in found.export.questions.items():
            if not (ratings["question"] == key).any():
                continue
            result = agreement(ratings, question)
            rows.append({"participants": people, **_agreement_row(result)})
            if people == "all":
                found.verdicts.append((key, verdict(result, question)))
    found.tables["agreement"] = pd.DataFrame(rows)


def _find_pairs(found: Findings, pairs: PairFindings) -> None:
    found.tables["pairs"] = pairs.found
    found.tables["pair_bias"] = pairs.bias
    found.tables["pair_scale"] = pairs.scale
    shares = pairs.found[pairs.found["layout"] == ALL_LAYOUTS]
    found.drawings["pairs"] = [
        draw_scores(
            as_share(question),
            shares[shares["question"] == key],
            pairs.cells[pairs.cells["question"] == key],
            found.source,
        )
        for key, question in found.export.questions.items()
        if (shares["question"] == key).any()
    ]


def _agreement_row(result: Agreement) -> dict[str, object]:
    row: dict[str, object] = {
        "question": result.question,
        "num_clips": result.num_clips,
        "num_raters": result.num_raters,
        "num_complete_raters": result.num_complete_raters,
    }
    estimates: dict[str, Estimate] = {f"alpha_{name}": result.alpha[name] for name in METRICS}
    estimates |= {"icc_2_1": result.icc_single, "icc_2_k": result.icc_mean}
    for name, estimate in estimates.items():
        row |= {name: estimate.value, f"{name}_low": estimate.low, f"{name}_high": estimate.high}
    return row | {"not_computed": result.reason}


def _find_tradeoff(
    found: Findings, name: str, points: pd.DataFrame, measures: tuple[Measure, ...]
) -> None:
    columns = ["question", "stimulus", "scene", "n", "mean", "ci_low", "ci_high"]
    columns += [measure.column for measure in measures] + ["failed_code"]
    if name == "cost":
        columns += [f"cpu_s_per_sim_s_{end}" for end in ("min", "q1", "q3")]
        columns += ["cost_num_runs", "cost_machine", "cost_build"]
    found.tables[f"rating_and_{name}"] = points[columns]
    drawings: list[Drawing] = []
    correlations: list[dict[str, object]] = []
    for measure in measures:
        for key, question in list(found.export.questions.items())[: page.MAX_CHART_QUESTIONS]:
            rows = points[points["question"] == key]
            if rows.empty or not (rows[measure.column].notna() | rows["failed"]).any():
                continue
            drawings.append(draw_tradeoff(as_share(question), measure, rows, found.source))
            about: dict[str, object] = {"question": key, "measure": measure.column}
            correlations.append({**about, **rank_correlation(rows, measure.column)})
    found.drawings[name] = drawings
    found.tables[f"rank_correlation_{name}"] = pd.DataFrame(correlations)


def _find_comments(found: Findings) -> None:
    rows = comment_rows(found.export, found.cohort.analysed)
    found.tables["comments"] = rows
    found.tables["comment_themes"] = theme_counts(rows)
    found.tables["comment_words"] = word_counts(rows)


def _write(found: Findings, folder: Path) -> None:
    """Write the whole analysis into a new folder. Tables without rows are not written."""
    (folder / "tables").mkdir(parents=True)
    (folder / "figures").mkdir()
    for name, table in found.tables.items():
        if len(table):
            table = table.copy()
            table.insert(0, "source", found.source)
            table.to_csv(
                folder / "tables" / f"{name}.csv",
                index=False,
                float_format="%.6g",
                lineterminator="\n",
                encoding="utf-8",
            )
    for drawings in found.drawings.values():
        for drawing in drawings:
            text = page.standalone_svg(drawing.svg)
            (folder / "figures" / f"{drawing.name}.svg").write_text(text, encoding="utf-8")
    log = runlog.run_log(found)
    text = json.dumps(log, indent=2, sort_keys=True, ensure_ascii=False) + "\n"
    (folder / LOG_FILE).write_text(text, encoding="utf-8")
    (folder / "report.html").write_text(page.render(found, log), encoding="utf-8")


def _choose_sections(only: Iterable[str] | None) -> tuple[str, ...]:
    if only is None:
        return SECTIONS
    asked = list(only)
    unknown = [name for name in asked if name not in SECTIONS]
    if unknown or not asked:
        raise AnalysisError(
            f"unknown section: {', '.join(map(repr, unknown)) or 'none given'}",
            f"use some of {', '.join(SECTIONS)}",
        )
    return tuple(name for name in SECTIONS if name in asked)


def _has_answers_for(section: str, export: Export) -> bool:
    """Whether a section applies to the study: choices between two clips are not ratings of one."""
    has_pairs = any(question.kind == CHOICE for question in export.questions.values())
    if section == "pairs":
        return has_pairs
    return section not in ("scores", "agreement") or not has_pairs


def _refuse_to_overwrite(out: Path, force: bool) -> None:
    if not out.exists():
        return
    if not out.is_dir():
        raise AnalysisError(f"{out} is a file", "name a folder that does not exist yet")
    empty = not any(out.iterdir())
    if empty or (force and (out / LOG_FILE).is_file()):
        return
    if force:
        raise AnalysisError(
            f"{out} holds no earlier analysis, so it is not replaced",
            "name another folder, or empty this one yourself",
        )
    raise AnalysisError(f"{out} is not empty", "name another folder, or add --force to replace it")
