# SPDX-License-Identifier: MIT
"""Puts each clip's mean rating beside what it cost to compute and how wrong its physics was."""

from __future__ import annotations

import math
import zlib
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import stats

from verisim.analysis import codebook
from verisim.analysis.agreement import NUM_DRAWS, SEED
from verisim.analysis.load import Export

COST = "cpu_s_per_sim_s_median"
MIN_CLIPS = 4  # a rank correlation of three points says nothing


@dataclass(frozen=True)
class Measure:
    """A figure of the engine drawn against ratings. zero: what exactly 0 means on a log axis."""

    column: str
    title: str
    label: str
    zero: str = "0"


COST_MEASURE = Measure(COST, "cost", "CPU seconds per simulated second")
ERROR_MEASURES = (
    Measure("max_penetration_m", "deepest overlap", "deepest overlap (m)", "no overlap"),
    Measure("error_to_reference_m", "distance from the reference run", "rms distance (m)", "same"),
    Measure("energy_residual_rel", "energy residual", "energy residual (share of scale)", "0"),
)


def join_engine(export: Export, scores: pd.DataFrame) -> pd.DataFrame:
    """Scores with role, scene, factors and engine figures of each clip beside them."""
    stimuli = export.tables["stimuli"]
    factors = [name for name in stimuli.columns if name.startswith("factor_")]
    about = stimuli[["stimulus", "role", "scene", "method", "seed", "reference", *factors]]
    engine = export.tables["engine"].drop(columns=["study", "source", "method"])
    joined = scores.merge(about, on="stimulus", how="left").merge(engine, on="stimulus", how="left")
    joined["is_reference"] = joined["stimulus"].isin(set(stimuli["reference"]) - {""})
    joined["failed"] = joined["failed_code"].fillna("").ne("")
    return joined


def why_no_cost(export: Export) -> str:
    """Why a cost chart is refused, as a sentence; empty when it can be drawn."""
    stimuli, engine = export.tables["stimuli"], export.tables["engine"]
    tested = engine["stimulus"].isin(stimuli.loc[stimuli["role"] == "test", "stimulus"])
    costed = engine[tested & engine[COST].notna()]
    if costed.empty and codebook.is_blind(export.description):
        return "The cost chart is refused: this is a blind export, which hides what a clip cost."
    if costed.empty:
        return (
            "The cost chart is refused: the export holds no measured cost. Run `verisim stimuli "
            "cost SET -o DIR`, export again and analyse again. Build times are never used instead."
        )
    machines = costed[["cost_machine", "cost_build"]].drop_duplicates()
    if len(machines) > 1:
        names = "; ".join(sorted(f"{m} ({b})" for m, b in machines.itertuples(index=False)))
        return (
            f"The cost chart is refused: costs come from {len(machines)} machines or builds "
            f"({names}), which one axis cannot compare. Measure all clips on one, with "
            "`verisim stimuli cost SET -o DIR`."
        )
    return ""


def rank_correlation(points: pd.DataFrame, column: str) -> dict[str, float]:
    """Spearman's rho between mean rating and a measure over clips, with its bootstrap interval.

    Clips whose run failed or that lack the measure are left out and not counted in n.
    """
    known = points[points[column].notna() & ~points["failed"]]
    x, y = known[column].to_numpy(dtype=float), known["mean"].to_numpy(dtype=float)
    rho = float(_spearman(x[None], y[None])[0])
    low = high = math.nan
    if not math.isnan(rho):
        key = f"{column}/{points['question'].iloc[0]}"
        rng = np.random.default_rng([SEED, zlib.crc32(key.encode())])
        rows = rng.integers(len(x), size=(NUM_DRAWS, len(x)))
        draws = _spearman(x[rows], y[rows])
        draws = draws[~np.isnan(draws)]
        if len(draws) >= 0.9 * NUM_DRAWS:
            low, high = (float(end) for end in np.percentile(draws, [2.5, 97.5]))
    return {"n": len(x), "rho": rho, "ci_low": low, "ci_high": high}


def _spearman(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Spearman's rho of each row of x with the same row of y; NaN where a row does not vary."""
    if x.shape[1] < MIN_CLIPS:
        return np.full(len(x), math.nan)
    ranks = [stats.rankdata(values, axis=1) for values in (x, y)]
    a, b = (rank - rank.mean(axis=1, keepdims=True) for rank in ranks)
    scale = np.sqrt((a**2).sum(axis=1) * (b**2).sum(axis=1))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.where(scale > 0, (a * b).sum(axis=1) / scale, math.nan))
