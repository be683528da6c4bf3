# SPDX-License-Identifier: MIT
"""Cases in which other engines fail, each with a limit of its own (tests/data/peer_failures).

    .venv/bin/python -m pytest tests/verification/test_peer_failures.py -s

prints what was measured beside the target and the best figure of another engine.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from quantities import QUANTITIES
from ruamel.yaml import YAML

from verisim import engine

FOLDER = Path(__file__).parent.parent / "data" / "peer_failures"
LIMITS: dict[str, list[dict[str, Any]]] = YAML(typ="safe").load(FOLDER / "limits.yaml")
CASES = [
    pytest.param(scene, limit, id=f"{scene}-{number}-{limit['quantity']}")
    for scene, limits in LIMITS.items()
    for number, limit in enumerate(limits)
]
SLACK = 1.5  # of a limit that is not met
ENERGY_RESIDUAL = 1e-3


def test_every_scene_of_the_folder_has_a_limit() -> None:
    scenes = {file.stem for file in FOLDER.glob("*.yaml")} - {"limits"}
    assert scenes == set(LIMITS)
    assert len(scenes) == 24  # the twenty-fifth case is a pile of 4000 boxes, run on request


@pytest.mark.parametrize(("scene", "limit"), CASES)
def test_what_fails_elsewhere_stays_within_its_limit(scene: str, limit: dict[str, Any]) -> None:
    file = FOLDER / f"{scene}.yaml"
    content = YAML(typ="safe").load(file)
    worst, residual, cost, failures = 0.0, 0.0, 0.0, set()
    for setting in limit.get("settings", [[]]):
        run = engine.simulate(file, setting)
        failures.add(run.summary["failed"]["code"] if run.summary["failed"] else None)
        if run.summary["failed"]:
            worst = float("inf")
            continue
        worst = max(worst, QUANTITIES[limit["quantity"]](run, content))
        residual = max(residual, run.summary["metrics"]["energy_residual_rel"])
        cost = max(cost, run.summary["cpu_s_per_sim_s"])

    met = worst <= limit["target"]
    peer = limit.get("best_peer", {"value": None, "engine": "not measured", "note": "-"})
    words = (
        f"{scene}: {limit['quantity']} {worst:.3g}, target {limit['target']:g}, "
        f"{'met' if met else 'NOT MET'}; best peer {peer['value']} ({peer['engine']}; "
        f"{peer['note']}); residual {residual:.1e}, {1000 * cost:.2f} ms CPU per s"
    )
    print("\n" + words)
    assert failures <= {None}, f"{failures}; {words}"
    assert residual < ENERGY_RESIDUAL, words
    if limit.get("met", True):
        assert met, words
    else:
        assert worst <= SLACK * limit["measured"], words
