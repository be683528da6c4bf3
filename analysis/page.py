# SPDX-License-Identifier: MIT
"""Fills the report's template; every text from the export is escaped there."""

from __future__ import annotations

import math
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from verisim.analysis.agreement import ALPHA_FIRM, ALPHA_TENTATIVE, main_metric
from verisim.analysis.codebook import is_blind, primary_question
from verisim.analysis.figures import Drawing, clip_label
from verisim.analysis.source import is_simulated

if TYPE_CHECKING:
    from verisim.analysis.report import Findings

TEMPLATES = Path(__file__).parent / "templates"
MAX_COMMENTS = 600
MAX_CHART_QUESTIONS = 8
TITLES = {
    "flow": "Who took part",
    "scores": "Ratings per clip",
    "agreement": "Do people agree?",
    "pairs": "Which of two?",
    "cost": "Rating against cost",
    "error": "Rating against physical error",
    "comments": "Comments",
}

LAYOUTS = {"all": "both ways", "sequential": "one after the other", "side_by_side": "side by side"}


def render(found: Findings, log: dict[str, object]) -> str:
    """The whole report as one HTML page without links to anything outside."""
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "clip": clip_label,
        "number": number,
        "interval": interval,
        "layout": lambda name: LAYOUTS.get(name, name),
    }
    return environment.get_template(
        "report.html.j2"
    ).render(
        study=found.export.study,
        source=found.source,
        simulated=is_simulated(found.source),
        sections=[(name, TITLES[name]) for name in found.sections],
        found=found,
        log=log,
        questions=found.export.questions,
        primary=primary_question(found.export.description),
        blind=is_blind(found.export.description),
        main_metric=main_metric,
        limits=(ALPHA_TENTATIVE, ALPHA_FIRM),
        records={name: table.to_dict("records") for name, table in found.tables.items()},
        score_grid=_score_grid(found.tables.get("scores")),
        difference_grid=_score_grid(found.tables.get("differences")),
        pair_grid=_pair_grid(found.tables.get("pairs")),
        moved=_largest_move(found.tables.get("scores")),
        comment_groups=_comment_groups(found),
        max_comments=MAX_COMMENTS,
        svg=lambda drawing: Markup(drawing.svg),  # our own drawing; its words are escaped
        notes=_notes,
        groups=_groups,
        not_drawn=list(found.export.questions)[MAX_CHART_QUESTIONS:],
    )


def standalone_svg(svg: str) -> str:
    """A figure as a file of its own."""
    return f'<?xml version="1.0" encoding="utf-8"?>\n{svg}\n'


def number(value: float, digits: int = 2) -> str:
    """A number for people; – where there is none."""
    return "–" if value is None or math.isnan(value) else f"{value:.{digits}f}".replace("-", "−")


def interval(low: float, high: float, digits: int = 2) -> str:
    """An interval for people; NaN: no bound on that side; empty where there is none."""
    if math.isnan(low) and math.isnan(high):
        return ""
    if math.isnan(high):
        return f"above {number(low, digits)}"
    if math.isnan(low):
        return f"below {number(high, digits)}"
    return f"{number(low, digits)} to {number(high, digits)}"


def _notes(drawings: list[Drawing]) -> list[str]:
    return list(dict.fromkeys(drawing.note for drawing in drawings if drawing.note))


def _groups(drawings: list[Drawing]) -> list[tuple[str, list[Drawing]]]:
    return [(name, list(group)) for name, group in groupby(drawings, lambda each: each.group)]


def _score_grid(scores: pd.DataFrame | None) -> dict[str, dict[str, Any]]:
    """clip -> question -> score, of all participants."""
    grid: dict[str, dict[str, Any]] = {}
    if scores is None:
        return grid
    rows = scores[scores["participants"] == "all"].sort_values(["stimulus", "question"])
    for row in rows.to_dict("records"):
        grid.setdefault(str(row["stimulus"]), {})[str(row["question"])] = row
    return grid


def _pair_grid(pairs: pd.DataFrame | None) -> dict[tuple[str, str], dict[str, Any]]:
    """(question, clip) -> layout -> its row, of all participants."""
    grid: dict[tuple[str, str], dict[str, Any]] = {}
    if pairs is None:
        return grid
    for row in pairs[pairs["participants"] == "all"].to_dict("records"):
        grid.setdefault((str(row["question"]), str(row["stimulus"])), {})[str(row["layout"])] = row
    return grid


def _largest_move(scores: pd.DataFrame | None) -> dict[str, Any] | None:
    """Where leaving out flagged people moves a mean the most; None when nobody is flagged."""
    if scores is None or scores["participants"].nunique() < 2:
        return None
    wide = scores.pivot(index=["question", "stimulus"], columns="participants", values="mean")
    moved = (wide["without flagged"] - wide["all"]).abs().dropna()
    if moved.empty:
        return None
    most = moved.reset_index(name="by").sort_values("by", kind="stable").iloc[-1]
    return {name: most[name] for name in ("question", "stimulus", "by")}


def _comment_groups(found: Findings) -> list[dict[str, Any]]:
    """Per clip: its comments with the writer's answers, and how often each theme occurs."""
    comments = found.tables.get("comments")
    if comments is None or comments.empty:
        return []
    themes = found.tables["comment_themes"]
    groups = []
    for stimulus, rows in comments.head(MAX_COMMENTS).groupby("stimulus", sort=True):
        counts = themes[themes["stimulus"] == stimulus].sort_values(
            ["num_comments", "theme"], ascending=[False, True]
        )
        groups.append(
            {
                "stimulus": stimulus,
                "themes": list(zip(counts["theme"], counts["num_comments"], strict=True)),
                "rows": [
                    {
                        "who": row["participant_id"],
                        "text": row["comment"],
                        "ratings": [
                            (key, row[f"rating_{key}"])
                            for key in found.export.questions
                            if not math.isnan(row[f"rating_{key}"])
                        ],
                    }
                    for row in rows.to_dict("records")
                ],
            }
        )
    return groups
