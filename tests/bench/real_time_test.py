# SPDX-License-Identifier: MIT
"""How many bodies fit into a frame, read off the piles that were run."""

from __future__ import annotations

import math

import pytest

from verisim.bench.chart.page import body_words, milliseconds
from verisim.bench.chart.real_time import crossing


def test_the_number_of_bodies_lies_between_the_piles_around_the_limit() -> None:
    bodies, seconds = [10, 100, 1000], [1e-3, 1e-2, 1e-1]
    assert crossing(bodies, seconds, 1e-2) == pytest.approx(100)
    assert crossing(bodies, seconds, math.sqrt(1e-3)) == pytest.approx(math.sqrt(1e5))


def test_nothing_is_read_off_beyond_the_piles() -> None:
    assert crossing([10, 100], [0.1, 1.0], 0.05) == 0
    assert crossing([10, 100], [0.1, 0.2], 0.5) == math.inf
    assert [body_words(n) for n in (0.0, math.inf, None, 1234.0)] == [
        "no",
        "more than tried",
        "not drawn here",
        "1200",
    ]


def test_times_of_a_frame_are_read_without_exponents() -> None:
    found = [milliseconds(s) for s in (None, math.inf, 7.32e-5, 0.333, 1.07)]
    assert found == ["–", "–", "0.0732", "333", "1070"]
