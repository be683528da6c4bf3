# SPDX-License-Identifier: MIT
"""The recursion that predicts method xpbd's maps has the closed forms of its fixed point."""

from __future__ import annotations

import pytest

from verisim.bench.stability.xpbd_column import settle, sweep_depth

FRAME = 1 / 60


@pytest.mark.parametrize("substeps", [4, 20])
def test_a_body_alone_rests_without_overlap(substeps: int) -> None:
    found = settle((1.0,), FRAME / substeps, 1.0, FRAME)
    assert found.deepest_m == pytest.approx(0, abs=1e-15)
    assert not found.rings


@pytest.mark.parametrize(("ratio", "swing"), [(1.0, 2.5), (100.0, 1.85)])
def test_the_deepest_swing_is_a_few_times_the_closed_form(ratio: float, swing: float) -> None:
    step = FRAME / 20
    found = settle((1.0, ratio), step, 2.0, FRAME)
    # The engine: 1.83 at ratio 100 (tests/dem/verify_xpbd_rest_test.cpp).
    assert found.deepest_m == pytest.approx(swing * sweep_depth(ratio, step), rel=0.1)


def test_overlap_falls_with_the_square_of_the_substep() -> None:
    coarse, fine = (settle((1.0,) * 10, FRAME / n, 2.0, FRAME).deepest_m for n in (10, 40))
    assert coarse / fine == pytest.approx(16, rel=0.05)


def test_a_far_heavier_box_rings_on_few_substeps() -> None:
    assert settle((1.0, 1e4), FRAME / 20, 2.0, FRAME).rings
