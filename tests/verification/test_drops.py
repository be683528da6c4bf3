# SPDX-License-Identifier: MIT
"""Twelve of the seeded drops of tests/data/drop_corpus; all of them run on request
(tests/stress/dem_drops_stress.py)."""

from __future__ import annotations

from pathlib import Path

import pytest
from drops import run_scenes, write_drops

DROPS = [
    ("sheet", 0),
    ("needle", 0),
    ("tile", 1),
    ("brick", 1),
    ("cube", 0),
    ("marble", 1),
    ("torus", 0),
    ("fox", 0),
    ("sponge", 0),
    ("grate", 1),
    ("marble_beside_crate", 1),
    ("tile_beside_boulder", 0),
]
LIMIT_S = 25


@pytest.mark.parametrize(("body", "seed"), DROPS)
def test_a_drop_ends_without_a_failure(tmp_path: Path, body: str, seed: int) -> None:
    (outcome,) = run_scenes(write_drops(tmp_path, [(body, seed)]), LIMIT_S)
    print(f"\n{outcome}")
    assert outcome.code is None, str(outcome)
    assert outcome.residual < 1e-3, str(outcome)  # measured 2.9e-4 at most
