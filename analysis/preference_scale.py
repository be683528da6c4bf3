# SPDX-License-Identifier: MIT
"""Davidson's model of choices between two: one strength per clip, "not sure" between equals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize
from scipy.sparse.csgraph import connected_components

FIRST, SECOND, TIE = 0, 1, 2


@dataclass(frozen=True)
class Scale:
    """strengths: log worth of each clip, mean 0. tie: Davidson's ν, 0 where all decided."""

    strengths: np.ndarray
    tie: float


def fit_scale(counts: np.ndarray) -> Scale | None:
    """Returns the maximum-likelihood scale, or None where it does not exist.

    counts [n, n, 3]: of the pair (i, j) with i < j, how often i was chosen, how often j, how often
    neither; the rest is 0. Davidson (1970), equations 2.1 to 2.3: i, j and neither are chosen as
    π_i : π_j : ν √(π_i π_j). Without ties this is the model of Bradley and Terry (1952). The
    maximum is finite only where every clip is, over some chain of choices, at least as good as
    every other (Ford 1957); an undecided answer counts in both directions.
    """
    n = len(counts)
    if n < 2 or not is_connected(counts):
        return None
    i, j = np.triu_indices(n, 1)
    pairs = counts[i, j].astype(float)
    asked = pairs.sum(axis=1)
    has_ties = bool(pairs[:, TIE].sum() > 0)
    if pairs[:, TIE].sum() == asked.sum():
        return None  # nobody chose anything: ν has no bound

    def loss(parameters: np.ndarray) -> tuple[float, np.ndarray]:
        strengths, log_tie = parameters[:n], parameters[n] if has_ties else -np.inf
        a, b = strengths[i], strengths[j]
        logs = np.stack([a, b, (a + b) / 2 + log_tie], axis=1)
        total = np.logaddexp.reduce(logs, axis=1)
        chances = np.exp(logs - total[:, None])
        used = np.where(pairs > 0, logs, 0.0)
        miss = asked[:, None] * chances - pairs
        slope = np.zeros(len(parameters))
        np.add.at(slope, i, miss[:, FIRST] + miss[:, TIE] / 2)
        np.add.at(slope, j, miss[:, SECOND] + miss[:, TIE] / 2)
        if has_ties:
            slope[n] = miss[:, TIE].sum()
        return float(asked @ total - (pairs * used).sum()), slope

    start = np.zeros(n + has_ties)
    found = minimize(loss, start, jac=True, method="BFGS", options={"gtol": 1e-7 * asked.sum()})
    strengths = found.x[:n] - found.x[:n].mean()
    return Scale(strengths, float(np.exp(found.x[n])) if has_ties else 0.0)


def is_connected(counts: np.ndarray) -> bool:
    """Whether a chain of choices leads from every clip to one that was no worse, and back."""
    ties = counts[..., TIE]
    better = counts[..., FIRST] + counts[..., SECOND].T + ties + ties.T
    return int(connected_components(better > 0, directed=True, connection="strong")[0]) == 1
