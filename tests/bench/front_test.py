# SPDX-License-Identifier: MIT
"""Fronts, ties and levels of the speed-accuracy chart."""

from __future__ import annotations

import math

import numpy as np
import pytest

from verisim.bench.chart.front import (
    Point,
    cheapest_within,
    dominates,
    front,
    is_tie,
    log_ratio_interval,
    ties,
)


def point(name: str, error: float, *costs: float, failed: str = "") -> Point:
    return Point("method", name, error, costs, failed)


def test_the_front_holds_what_nothing_beats_in_cost_and_error() -> None:
    points = [
        point("cheap", 1.0, 1, 1),
        point("middle", 0.1, 2, 2),
        point("worse", 0.2, 3, 3),
        point("fine", 0.01, 9, 9),
        point("as good, dearer", 0.01, 10, 10),
    ]
    assert [each.setting for each in front(points)] == ["cheap", "middle", "fine"]


def test_failures_and_runs_without_cost_stand_on_no_front() -> None:
    lost = point("lost", 0.0, 1, failed="bounce lost")
    assert front([lost, point("nan", math.inf, 1), point("unrun", 0.1), point("ok", 0.5, 2)]) == [
        point("ok", 0.5, 2)
    ]


def test_costs_within_the_noise_are_a_tie_and_dominate_nothing() -> None:
    a, b = point("a", 0.1, 1.0, 1.1, 0.9, 1.05), point("b", 0.2, 1.04, 1.14, 0.94, 1.02)
    assert is_tie(a, b) and not dominates(a, b)
    assert front([a, b]) == [a]
    assert ties([a, b]) == [b]
    sure = point("c", 0.2, 2.0, 2.1, 1.9, 2.05)
    assert dominates(a, sure) and not dominates(sure, a)
    assert ties([a, sure]) == []


def test_one_run_tells_nothing_about_noise() -> None:
    assert log_ratio_interval((1.0,), (9.0, 9.1)) == (-math.inf, math.inf)


def test_the_interval_covers_the_true_ratio_as_often_as_it_says() -> None:
    rng = np.random.default_rng(4)
    truth, covered = math.log(1.3), 0
    for _ in range(1000):
        a = np.exp(truth + 0.05 * rng.normal(size=10))
        b = np.exp(0.2 * rng.normal(size=3))
        low, high = log_ratio_interval(tuple(a), tuple(b))
        covered += low <= truth <= high
    assert covered == pytest.approx(950, abs=25)  # measured 950; binomial sd 7


def test_the_cheapest_within_a_level_may_be_finer_than_asked() -> None:
    points = [point("coarse", 0.5, 1), point("fine", 1e-4, 2), point("middle", 5e-3, 3)]
    found = cheapest_within(points, 1e-2)
    assert found is not None and found.setting == "fine"
    assert cheapest_within(points, 1e-5) is None
