# SPDX-License-Identifier: MIT
"""Agreement figures: published worked examples, invariance, and data that allow no figure."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

from verisim.analysis.agreement import agreement, icc, krippendorff_alpha, verdict
from verisim.analysis.codebook import Question

RATING = Question("realism", "rating", 1, 7)


def matrix(*raters: str) -> np.ndarray:
    """Unit × rater from one text per rater; a dot is a missing answer."""
    rows = [rater.replace(".", "nan").split() for rater in raters]
    return np.array(rows, dtype=float).T


# Krippendorff 2011, section C: four observers, twelve units.
KRIPPENDORFF_2011 = matrix(
    "1 2 3 3 2 1 4 1 2 . . .",
    "1 2 3 3 2 2 4 1 2 5 . 3",
    ". 3 3 3 2 3 4 2 2 5 1 .",
    "1 2 3 3 2 4 4 1 2 5 1 .",
)
# The worked example of the Wikipedia article on alpha: three coders, fifteen units, many gaps.
THREE_CODERS = matrix(
    ". . . . . 3 4 1 2 1 1 3 3 . 3",
    "1 . 2 1 3 3 4 3 . . . . . . .",
    ". . 2 1 3 4 4 . 2 1 1 3 3 . 4",
)
# Shrout and Fleiss 1979, table 2: six targets, four judges.
SHROUT_FLEISS = np.array(
    [[9, 2, 5, 8], [6, 1, 3, 2], [8, 4, 6, 8], [7, 1, 2, 6], [10, 5, 6, 9], [6, 2, 4, 7]], float
)


@pytest.mark.parametrize(
    ("data", "metric", "published"),
    [
        (KRIPPENDORFF_2011, "nominal", 0.743421),
        (KRIPPENDORFF_2011, "ordinal", 0.815388),
        (KRIPPENDORFF_2011, "interval", 0.849107),
        (THREE_CODERS, "nominal", 0.691358),
        (THREE_CODERS, "ordinal", 0.806721),
        (THREE_CODERS, "interval", 0.810845),
    ],
)
def test_alpha_is_the_published_one(data: np.ndarray, metric: str, published: float) -> None:
    # Printed to six digits: measured distance below 5e-7, bound 1e-6.
    assert krippendorff_alpha(data, metric) == pytest.approx(published, abs=1e-6)


def test_icc_is_the_published_one() -> None:
    single, mean = icc(SHROUT_FLEISS)
    # Shrout and Fleiss print .29 and .62; six digits from two packages. Measured 4e-7, bound 2e-6.
    assert single == pytest.approx(0.289764, abs=2e-6)
    assert mean == pytest.approx(0.620051, abs=2e-6)


def test_alpha_is_one_for_equal_raters_and_about_zero_for_noise() -> None:
    rng = np.random.default_rng(3)
    same = np.repeat(rng.integers(1, 8, (40, 1)), 5, axis=1).astype(float)
    assert krippendorff_alpha(same, "ordinal") == pytest.approx(1.0)
    noise = rng.integers(1, 8, (400, 5)).astype(float)
    # Measured 0.004 with this seed; the spread over seeds is about 0.02.
    assert abs(krippendorff_alpha(noise, "ordinal")) < 0.06


def long(data: np.ndarray, names: list[str]) -> pd.DataFrame:
    """Rows as scores.rated_cells gives them."""
    rows = [
        ("realism", f"clip{unit:02d}", name, data[unit, rater])
        for unit in range(data.shape[0])
        for rater, name in enumerate(names)
        if not math.isnan(data[unit, rater])
    ]
    return pd.DataFrame(rows, columns=["question", "stimulus", "participant_id", "value"])


def test_names_of_raters_and_order_of_rows_change_nothing() -> None:
    # Thirds: no sum of them is exact, so that an order of summing shows in the last bit.
    answers = np.random.default_rng(4).integers(3, 22, (9, 7)) / 3
    first = agreement(long(answers, list("abcdefg")), RATING)
    renamed = long(answers, list("gzbfaec")).sample(frac=1, random_state=5)
    assert agreement(renamed, RATING) == first


def test_intervals_hold_the_value_and_narrow_with_more_clips() -> None:
    rng = np.random.default_rng(8)
    quality = rng.uniform(1, 7, (80, 1))
    answers = np.clip(np.round(quality + rng.normal(0, 0.8, (80, 6))), 1, 7)
    names = list("abcdef")
    few = agreement(long(answers[:10], names), RATING).alpha["ordinal"]
    many = agreement(long(answers, names), RATING).alpha["ordinal"]
    assert few.low < few.value < few.high
    assert many.low < many.value < many.high
    assert many.high - many.low < few.high - few.low


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (np.full((6, 4), 4.0), "everybody gave the same answer (4) to every clip"),
        (SHROUT_FLEISS[:, :1], "only one person answered"),
        (SHROUT_FLEISS[:1], "only one clip was rated by two people"),
        (matrix("1 . 3 .", ". 2 . 4"), "no clip was rated by two people"),
    ],
)
def test_data_that_allow_no_figure_are_named(data: np.ndarray, words: str) -> None:
    result = agreement(long(data, [f"p{rater}" for rater in range(data.shape[1])]), RATING)
    assert all(math.isnan(estimate.value) for estimate in result.alpha.values())
    assert verdict(result, RATING) == f"Agreement cannot be computed: {words}."


def test_icc_uses_only_raters_who_rated_every_clip() -> None:
    gap = SHROUT_FLEISS.copy()
    gap[2, 3] = math.nan
    result = agreement(long(gap, ["a", "b", "c", "d"]), RATING)
    assert (result.num_raters, result.num_complete_raters) == (4, 3)
    assert result.icc_single.value == pytest.approx(icc(SHROUT_FLEISS[:, :3])[0])


@pytest.mark.parametrize(
    ("noise", "words"), [(0.1, "agree well"), (1.0, "tentative"), (2.2, "too little")]
)
def test_verdict_follows_the_cut_offs(noise: float, words: str) -> None:
    rng = np.random.default_rng(2)
    answers = rng.uniform(1, 7, (60, 1)) + rng.normal(0, noise, (60, 5))
    question = Question("realism", "slider", 0, 100)
    sentence = verdict(agreement(long(np.round(answers * 5), list("abcde")), question), question)
    assert words in sentence
