# SPDX-License-Identifier: MIT
"""Two hundred seeded drops of tests/data/drop_corpus with automatic parameters. Run on request:

    .venv/bin/python -m pytest tests/stress/dem_drops_stress.py -s

Prints code, seed, body and step of every failure, and the share of drops that fail.
"""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent.parent / "verification"))
from drops import corpus, run_scenes, write_drops

SEEDS = range(10)
LIMIT_S = 20  # CPU time of one drop
ENERGY_RESIDUAL = 1e-3
# Not met today: eight drops of meshes with many holes take longer.
MAX_SLOW, MAX_UNEXPLAINED = 9, 1


@pytest.mark.timeout(3600)
def test_two_hundred_drops_end_without_a_failure_code(tmp_path: Path) -> None:
    drops = [(body, seed) for body in sorted(corpus()) for seed in SEEDS]
    assert len(drops) == 200
    outcomes = run_scenes(write_drops(tmp_path, drops), LIMIT_S, num_processes=2)
    failed = [outcome for outcome in outcomes if outcome.code not in (None, "timeout")]
    slow = [outcome for outcome in outcomes if outcome.code == "timeout"]
    unexplained = [outcome for outcome in outcomes if outcome.residual > ENERGY_RESIDUAL]
    for words, group in (("failed", failed), ("slow", slow), ("energy", unexplained)):
        print(f"\n{words}: {len(group)} of {len(outcomes)}, {len(group) / len(outcomes):.1%}")
        for outcome in sorted(group, key=lambda outcome: outcome.name):
            print(f"  {outcome}")
    assert not failed  # target and measured: 0
    assert len(slow) <= MAX_SLOW  # target 0
    assert len(unexplained) <= MAX_UNEXPLAINED  # target 0
