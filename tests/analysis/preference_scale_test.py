# SPDX-License-Identifier: MIT
"""The scale of choices between two gives the published results of published data."""

from __future__ import annotations

import numpy as np
import pytest

from verisim.analysis.preference_scale import fit_scale

# Davidson (1970): six brands of chocolate pudding; i, j, chosen i, chosen j, no preference.
PUDDINGS = """
1 2 19 22 16 | 1 3 16 19 12 | 2 3 19 19 10 | 1 4 18 23 13 | 2 4 23 19 9 | 3 4 19 20 15
1 5 13 19 18 | 2 5 16 20 12 | 3 5 16 15 17 | 4 5 17 14 16 | 1 6 18 21 12 | 2 6 22 20 12
3 6 13 18 10 | 4 6 14 19 18 | 5 6 11 21 12
"""
# Agresti (2002), section 10.6: wins in 13 games each, American League East 1987.
TEAMS = ("Milwaukee", "Detroit", "Toronto", "New York", "Boston", "Cleveland", "Baltimore")
WINS = np.array([
    [0, 7, 9, 7, 7, 9, 11],
    [6, 0, 7, 5, 11, 9, 9],
    [4, 6, 0, 7, 7, 8, 12],
    [6, 8, 6, 0, 6, 7, 10],
    [6, 2, 6, 7, 0, 7, 12],
    [4, 4, 5, 6, 6, 0, 6],
    [2, 4, 1, 3, 1, 7, 0],
])  # fmt: skip


def pudding_counts() -> np.ndarray:
    counts = np.zeros((6, 6, 3))
    for line in PUDDINGS.replace("\n", "|").split("|"):
        if line.strip():
            i, j, *outcome = map(int, line.split())
            counts[i - 1, j - 1] = outcome
    return counts


def test_davidsons_puddings_come_out() -> None:
    scale = fit_scale(pudding_counts())
    assert scale is not None
    worth = np.exp(scale.strengths) / np.exp(scale.strengths).sum()
    # Published after seven rounds of his iteration; measured 2e-5 from the maximum.
    published = [0.1388005, 0.1729985, 0.1617420, 0.1653930, 0.1586805, 0.2023855]
    assert worth == pytest.approx(published, abs=1e-4)
    assert scale.tie == pytest.approx(0.7468147, abs=1e-4)


def test_bradley_and_terry_is_the_case_without_ties() -> None:
    counts = np.zeros((7, 7, 3))
    counts[..., 0] = np.triu(WINS)
    counts[..., 1] = np.triu(WINS.T)
    scale = fit_scale(counts)
    assert scale is not None and scale.tie == 0
    above_last = dict(zip(TEAMS, np.round(scale.strengths - scale.strengths[-1], 2), strict=True))
    assert above_last == {
        "Milwaukee": 1.58, "Detroit": 1.44, "Toronto": 1.29, "New York": 1.25, "Boston": 1.11,
        "Cleveland": 0.68, "Baltimore": 0.0,
    }  # fmt: skip


def test_the_order_of_the_clips_does_not_matter() -> None:
    counts = pudding_counts()
    order = np.array([3, 0, 5, 1, 4, 2])
    turned = np.zeros_like(counts)
    for a, i in enumerate(order):
        for b, j in enumerate(order):
            if a < b:
                turned[a, b] = counts[i, j] if i < j else counts[j, i][[1, 0, 2]]
    scale, other = fit_scale(counts), fit_scale(turned)
    assert scale is not None and other is not None
    assert other.strengths == pytest.approx(scale.strengths[order], abs=1e-6)  # measured 2e-8


def test_a_clip_that_always_loses_has_no_place_on_the_scale() -> None:
    counts = pudding_counts()
    counts[0, 1:] = [0, 10, 0]
    assert fit_scale(counts) is None
    counts[0, 1] = [0, 9, 1]  # once level with another: finite
    assert fit_scale(counts) is not None


def test_clips_that_were_never_compared_have_no_common_scale() -> None:
    counts = np.zeros((4, 4, 3))
    counts[0, 1] = counts[2, 3] = [3, 4, 2]
    assert fit_scale(counts) is None
    assert fit_scale(np.zeros((1, 1, 3))) is None


def test_nobody_deciding_gives_no_scale() -> None:
    counts = np.zeros((3, 3, 3))
    counts[0, 1] = counts[1, 2] = counts[0, 2] = [0, 0, 5]
    assert fit_scale(counts) is None
