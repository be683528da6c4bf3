# SPDX-License-Identifier: MIT
"""Chooses whose answers are analysed: people's and simulated ones are never mixed."""

from __future__ import annotations

from dataclasses import replace

from verisim.analysis.columns import LIVE_SOURCES, SIMULATED, TABLES
from verisim.analysis.load import Export
from verisim.analysis.problems import AnalysisError

LIVE = "live"


def choose_source(export: Export, source: str | None) -> tuple[Export, str]:
    """The export with the rows of one source only, and the words that name it.

    source: None (all, when people and simulated raters are not mixed), one source's name, or
    "live" for every source but simulated. Raises AnalysisError when the choice is not possible.
    """
    present = sorted(set(export.tables["participants"]["source"]))
    known = {*LIVE_SOURCES, SIMULATED, LIVE}
    found = ", ".join(present) or "none"
    if source is None:
        if SIMULATED in present and len(present) > 1:
            raise AnalysisError(
                f"the export mixes simulated answers with live ones (sources: {found})",
                "name the one to analyse: --source simulated, --source live, or "
                + ", ".join(f"--source {name}" for name in present if name != SIMULATED),
            )
        kept = present
    elif source not in known:
        raise AnalysisError(
            f"unknown source {source!r}", f"use one of {', '.join(sorted(known))}; here: {found}"
        )
    else:
        kept = [name for name in present if name == source or (source == LIVE != name != SIMULATED)]
        if not kept:
            raise AnalysisError(f"no answers with source {source!r}", f"this export has: {found}")
    tables = {
        name: rows[rows["source"].isin(kept)] if TABLES[name].of_people else rows
        for name, rows in export.tables.items()
    }
    return replace(export, tables=tables), " and ".join(kept) or "no answers"


def is_simulated(source: str) -> bool:
    """Whether the words that name a source mean scripted raters."""
    return source == SIMULATED
