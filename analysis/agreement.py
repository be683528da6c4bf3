# SPDX-License-Identifier: MIT
"""Do raters agree? Krippendorff's alpha and ICC with bootstrap intervals over clips."""

from __future__ import annotations

import math
import zlib
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from verisim.analysis.codebook import Question

Matrix = NDArray[np.float64]

METRICS = ("nominal", "ordinal", "interval")
NUM_DRAWS = 1000
SEED = 20_241
DRAWS_AT_ONCE = 100  # keeps a 0-100 slider's matrices below 10 MB each
# Conventional readings of alpha; conventions, not laws, and named as such in the report.
ALPHA_TENTATIVE = 0.667
ALPHA_FIRM = 0.8
MIN_VALID_DRAWS = 0.9  # fewer draws with a defined value: no interval is given


@dataclass(frozen=True)
class Estimate:
    """A value and its 95 % bootstrap interval; NaN where it cannot be computed."""

    value: float
    low: float = math.nan
    high: float = math.nan


@dataclass(frozen=True)
class Agreement:
    """All agreement figures of one question. reason: why alpha is missing, else empty."""

    question: str
    num_clips: int
    num_raters: int
    num_complete_raters: int
    alpha: dict[str, Estimate]
    icc_single: Estimate
    icc_mean: Estimate
    reason: str = ""


def coincidences(ratings: Matrix) -> tuple[Matrix, NDArray[np.float64]]:
    """Coincidence matrix of every pairable unit, and the sorted values it counts.

    ratings: unit × rater, NaN = not rated. Units with fewer than two answers pair nothing and
    are left out. Result: unit × value × value. Source: Krippendorff 2011, section E.
    """
    values = np.unique(ratings[~np.isnan(ratings)])
    counts = (ratings[:, :, None] == values[None, None, :]).sum(axis=1).astype(float)
    size = counts.sum(axis=1)
    counts, size = counts[size >= 2], size[size >= 2]
    pairs = counts[:, :, None] * counts[:, None, :]
    diagonal = np.arange(len(values))
    pairs[:, diagonal, diagonal] -= counts
    return pairs / (size - 1)[:, None, None], values


def alphas_of_coincidences(coincidence: Matrix, values: Matrix, metric: str) -> Matrix:
    """Krippendorff's alpha of each value × value matrix of a stack; NaN where nothing varies."""
    marginal = coincidence.sum(axis=2)
    total = marginal.sum(axis=1)
    distance = _squared_distance(marginal, values, metric)
    expected = np.einsum("dc,dk,dck->d", marginal, marginal, distance)
    observed = (coincidence * distance).sum(axis=(1, 2))
    alphas = np.full(len(coincidence), math.nan)
    known = (total >= 2) & (expected > 0)
    alphas[known] = 1 - (total[known] - 1) * observed[known] / expected[known]
    return alphas


def krippendorff_alpha(ratings: Matrix, metric: str) -> float:
    """Alpha of unit × rater answers (NaN = missing). metric: nominal | ordinal | interval."""
    per_unit, values = coincidences(ratings)
    return float(alphas_of_coincidences(per_unit.sum(axis=0)[None], values, metric)[0])


def icc(ratings: Matrix) -> tuple[float, float]:
    """ICC(2,1) and ICC(2,k): absolute agreement, raters random. ratings: clip × rater, no gaps.

    NaN when there are fewer than two clips or raters, or nothing varies.
    Source: Shrout and Fleiss 1979, case 2.
    """
    single, mean = _iccs(ratings[None])
    return float(single[0]), float(mean[0])


def agreement(ratings: pd.DataFrame, question: Question) -> Agreement:
    """Agreement on one question. ratings: rows of scores.rated_cells, any questions."""
    rows = ratings[ratings["question"] == question.key]
    wide = rows.pivot(index="stimulus", columns="participant_id", values="value").sort_index()
    matrix = wide.to_numpy(dtype=float)
    complete = matrix[:, ~np.isnan(matrix).any(axis=0)]
    # Sorted columns: the names of the raters must not decide the order of sums.
    complete = complete[:, np.lexsort(complete)] if complete.size else complete
    per_unit, values = coincidences(matrix)
    reason = _why_undefined(matrix, per_unit, values)
    rng = np.random.default_rng([SEED, zlib.crc32(question.key.encode())])
    alphas = {
        metric: _alpha_estimate(per_unit, values, metric, rng) if not reason else Estimate(math.nan)
        for metric in METRICS
    }
    single, mean = _icc_estimates(complete, rng)
    raters = matrix.shape[1], complete.shape[1]
    return Agreement(question.key, len(per_unit), *raters, alphas, single, mean, reason)


def main_metric(question: Question) -> str:
    """Ratings are ordinal; a slider's steps are meant to be equal."""
    return "interval" if question.kind == "slider" else "ordinal"


def verdict(result: Agreement, question: Question) -> str:
    """What the figures mean, in plain words."""
    alpha = result.alpha[main_metric(question)]
    if result.reason:
        return f"Agreement cannot be computed: {result.reason}."
    if alpha.value >= ALPHA_FIRM:
        text = "Single people agree well with one another"
    elif alpha.value >= ALPHA_TENTATIVE:
        text = "Single people agree, but only enough for tentative conclusions"
    elif alpha.value > 0:
        text = "Single people agree too little for one person's answer to stand for others"
    else:
        text = "Single people agree no more than chance would make them"
    text += f" (alpha {alpha.value:.2f})."
    for limit in (ALPHA_TENTATIVE, ALPHA_FIRM):
        if alpha.low < limit <= alpha.high:
            text += f" The interval reaches across {limit:g}, so other clips could change this."
            break
    if not math.isnan(result.icc_mean.value):
        text += (
            f" The mean over {result.num_complete_raters} people has reliability "
            f"{max(0.0, result.icc_mean.value):.2f} (1 = other people would give the same means)."
        )
    elif result.num_complete_raters < 2:
        text += " Fewer than two people rated every clip, so no ICC is given."
    return text


def _squared_distance(marginal: Matrix, values: Matrix, metric: str) -> Matrix:
    """Squared distance between values, one matrix for each row of marginals or one for all."""
    if metric == "nominal":
        return 1.0 - np.eye(len(values))[None]
    if metric == "interval":
        return np.asarray((values[:, None] - values[None, :]) ** 2)[None]
    if metric != "ordinal":
        raise ValueError(f"unknown metric {metric!r}; use one of {', '.join(METRICS)}")
    # Sum of marginals from c to k, less half of both ends (Krippendorff 2011, ordinal metric).
    middle = np.cumsum(marginal, axis=1) - marginal / 2
    return np.asarray((middle[:, :, None] - middle[:, None, :]) ** 2)


def _iccs(stack: Matrix) -> tuple[Matrix, Matrix]:
    """ICC(2,1) and ICC(2,k) of each clip × rater matrix of a stack, from two-way mean squares."""
    num_draws, num_clips, num_raters = stack.shape
    if num_clips < 2 or num_raters < 2:
        return np.full(num_draws, math.nan), np.full(num_draws, math.nan)
    grand = stack.mean(axis=(1, 2), keepdims=True)
    clip, rater = stack.mean(axis=2, keepdims=True), stack.mean(axis=1, keepdims=True)
    between_clips = num_raters * ((clip - grand) ** 2).sum(axis=(1, 2)) / (num_clips - 1)
    between_raters = num_clips * ((rater - grand) ** 2).sum(axis=(1, 2)) / (num_raters - 1)
    rest = ((stack - clip - rater + grand) ** 2).sum(axis=(1, 2))
    error = rest / ((num_clips - 1) * (num_raters - 1))
    spread = between_raters - error
    single = between_clips + (num_raters - 1) * error + num_raters * spread / num_clips
    mean = between_clips + spread / num_clips
    # Rounding leaves about 1e-30 where nothing varies; a ratio of such numbers means nothing.
    known = np.minimum(single, mean) > 1e-12 * (1.0 + grand[:, 0, 0] ** 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        above = between_clips - error
        return (
            np.where(known, above / single, math.nan),
            np.where(known, above / mean, math.nan),
        )


def _alpha_estimate(
    per_unit: Matrix, values: Matrix, metric: str, rng: np.random.Generator
) -> Estimate:
    num_units, num_values = len(per_unit), len(values)
    value = alphas_of_coincidences(per_unit.sum(axis=0)[None], values, metric)[0]
    weights = rng.multinomial(num_units, np.full(num_units, 1 / num_units), size=NUM_DRAWS)
    flat = per_unit.reshape(num_units, -1)
    draws = [
        alphas_of_coincidences(
            (part @ flat).reshape(len(part), num_values, num_values), values, metric
        )
        for part in np.array_split(weights.astype(float), NUM_DRAWS // DRAWS_AT_ONCE)
    ]
    return Estimate(float(value), *_percentiles(np.concatenate(draws)))


def _icc_estimates(complete: Matrix, rng: np.random.Generator) -> tuple[Estimate, Estimate]:
    single, mean = icc(complete)
    if math.isnan(single):
        return Estimate(math.nan), Estimate(math.nan)
    rows = rng.integers(len(complete), size=(NUM_DRAWS, len(complete)))
    parts = [_iccs(complete[part]) for part in np.array_split(rows, NUM_DRAWS // DRAWS_AT_ONCE)]
    singles, means = (np.concatenate(draws) for draws in zip(*parts, strict=True))
    return Estimate(single, *_percentiles(singles)), Estimate(mean, *_percentiles(means))


def _percentiles(draws: Matrix) -> tuple[float, float]:
    valid = draws[~np.isnan(draws)]
    if len(valid) < MIN_VALID_DRAWS * len(draws):
        return math.nan, math.nan
    low, high = np.percentile(valid, [2.5, 97.5])
    return float(low), float(high)


def _why_undefined(matrix: Matrix, per_unit: Matrix, values: Matrix) -> str:
    if matrix.shape[1] < 2:
        return "only one person answered" if matrix.shape[1] else "nobody answered"
    if len(per_unit) == 0:
        return "no clip was rated by two people"
    paired = per_unit.sum(axis=(0, 1))
    if np.count_nonzero(paired) < 2:
        return f"everybody gave the same answer ({values[np.argmax(paired)]:g}) to every clip"
    if len(per_unit) < 2:
        return "only one clip was rated by two people"
    return ""
