# SPDX-License-Identifier: MIT
"""Mean rating of every clip on every question, with its spread and 95 % t interval."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from scipy import stats

from verisim.analysis.load import Export

CONFIDENCE = 0.95
DIFFERENCE_COLUMNS = (
    "participants", "question", "stimulus", "reference",
    "n", "mean", "sd", "ci_low", "ci_high",
)  # fmt: skip
SCORE_COLUMNS = ("participants", "question", "stimulus", "n", "mean", "sd", "ci_low", "ci_high")


def rated_cells(export: Export, participants: frozenset[str]) -> pd.DataFrame:
    """One row per participant × clip × question: the mean of that person's answers to it.

    Only single-clip test trials count; practice, catch and repeated trials do not. Questions with
    several items have no single value.
    """
    rows = export.tables["ratings"]
    rows = rows[
        (rows["trial_kind"] == "test")
        & rows["participant_id"].isin(participants)
        & rows["value"].notna()
        & (rows["stimulus_b"] == "")
        & (rows["item"] == "")
    ]
    cells = rows.groupby(["question", "stimulus", "participant_id"], sort=True)["value"]
    return cells.mean().reset_index()


def mean_interval(values: np.ndarray) -> tuple[float, float, float, float]:
    """Mean, sd, and the two-sided 95 % Student-t interval of the mean; NaN where undefined.

    values: n answers, n >= 1. Sorted first, so that the order of raters cannot change a bit.
    """
    values = np.sort(values)
    mean = float(np.mean(values))
    if len(values) < 2:
        return mean, math.nan, math.nan, math.nan
    sd = float(np.std(values, ddof=1))
    quantile = float(stats.t.ppf(0.5 + CONFIDENCE / 2, len(values) - 1))
    half = quantile * sd / math.sqrt(len(values))
    return mean, sd, mean - half, mean + half


def clip_scores(ratings: pd.DataFrame, participants: str) -> pd.DataFrame:
    """One row per question × clip. participants: the name of the participant set."""
    rows = []
    for (question, stimulus), group in ratings.groupby(["question", "stimulus"], sort=True):
        values = group["value"].to_numpy(dtype=float)
        rows.append([participants, question, stimulus, len(values), *mean_interval(values)])
    return pd.DataFrame(rows, columns=list(SCORE_COLUMNS))


def reference_differences(
    ratings: pd.DataFrame, stimuli: pd.DataFrame, participants: str
) -> pd.DataFrame:
    """Per question × clip: its rating less that of its reference clip by the same person.

    Only people who rated both count. ratings: rows of rated_cells.
    """
    pairs = ratings.merge(stimuli.loc[stimuli["reference"] != "", ["stimulus", "reference"]])
    pairs = pairs.merge(
        ratings.rename(columns={"stimulus": "reference", "value": "reference_value"}),
        on=["question", "participant_id", "reference"],
    )
    rows = []
    for (question, stimulus), group in pairs.groupby(["question", "stimulus"], sort=True):
        values = (group["value"] - group["reference_value"]).to_numpy(dtype=float)
        interval = mean_interval(values)
        about = [participants, question, stimulus, group["reference"].iloc[0]]
        rows.append([*about, len(values), *interval])
    return pd.DataFrame(rows, columns=list(DIFFERENCE_COLUMNS))


def repeat_differences(export: Export, participants: frozenset[str]) -> pd.DataFrame:
    """Per question: how far the answers to a repeated clip lie from the first ones."""
    rows = export.tables["ratings"]
    rows = rows[
        rows["participant_id"].isin(participants)
        & rows["value"].notna()
        & rows["trial_kind"].isin(["test", "repeat"])
    ]
    wide = rows.pivot_table(
        index=["question", "participant_id", "stimulus"],
        columns="trial_kind",
        values="value",
        aggfunc="mean",
    )
    if not {"test", "repeat"} <= set(wide.columns):
        return pd.DataFrame(columns=["question", "n_pairs", "mean_absolute_difference"])
    pairs = (wide["repeat"] - wide["test"]).dropna().abs().groupby("question", sort=True)
    return pd.DataFrame(
        {"n_pairs": pairs.count(), "mean_absolute_difference": pairs.mean()}
    ).reset_index()
