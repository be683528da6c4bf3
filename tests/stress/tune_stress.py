# SPDX-License-Identifier: MIT
"""`verisim tune` on every scene of the bench. Run on request; a scene by -k:

    .venv/bin/python -m pytest tests/stress/tune_stress.py -s -k "bounce or tower"

Prints what was chosen, what the file that was written does, and what the choice costs beside the
cheapest setting that meets the bound, both measured anew in turn.
"""

from __future__ import annotations

import shutil
from pathlib import Path
from statistics import median
from typing import Any

import pytest

from verisim import engine
from verisim.bench.chart.bench_scene import BenchScene
from verisim.bench.chart.catalogue import all_scenes
from verisim.bench.chart.tune import Bound, Candidate, Tuned, tune
from verisim.bench.chart.write_physics import write_physics

MOST = 1.2  # times the cost of the front
RIVALS, NEAR = 5, 2.0  # settings run again beside the chosen: of at most twice its cost
LEAST_ROUNDS, MOST_ROUNDS, SPENT_S = 3, 40, 0.5
ERROR = Bound("error_m", 1e-3)
DEPTH = Bound("penetration_m", 1e-3)
# What lies or is thrown chaotically has no one way to be near to.
BY_DEPTH = ("tower", "mass_ratio", "pile", "tumbled", "stones", "spheres", "dice", "cloud", "cubes")
XPBD = ("bounce", "incline_slip", "tower_5")


def bound_of(scene: BenchScene) -> Bound:
    return DEPTH if any(word in scene.key for word in BY_DEPTH) else ERROR


@pytest.mark.timeout(7200)
@pytest.mark.parametrize("scene", all_scenes(), ids=lambda scene: scene.key)
def test_the_choice_meets_its_bound_and_costs_little_more_than_the_front(
    scene: BenchScene, tmp_path: Path
) -> None:
    check(scene, tmp_path, None)


@pytest.mark.timeout(7200)
@pytest.mark.parametrize("key", XPBD)
def test_so_does_that_of_method_xpbd(key: str, tmp_path: Path) -> None:
    check(next(scene for scene in all_scenes() if scene.key == key), tmp_path, ["xpbd"])


def check(scene: BenchScene, folder: Path, methods: list[str] | None) -> None:
    bound = bound_of(scene)
    made = scene.write(folder)
    file = folder / "tuned.yaml"
    shutil.copy(made, file)
    found = tune(file, bound, methods=methods)
    assert found.chosen is not None, least_words(found)
    write_physics(file, found.chosen.overrides)
    assert found.again is not None
    value = found.again.values[bound.kind]
    costs = costs_in_turn(made, found)
    own, least = costs[found.chosen.setting], min(costs.values())
    rival = min(costs, key=lambda name: costs[name])
    print(
        f"\n{scene.key}: {found.chosen.method}, {found.chosen.setting}: {bound.kind} {value:.3g} "
        f"of {bound.most:g}; {1e3 * own:.3g} ms/s, {own / least:.2f} of the front ({rival})"
    )
    assert found.holds, f"{bound.kind} {value}"
    depth = engine.simulate(file, num_threads=1).summary["metrics"]["max_penetration_m"]
    assert depth == found.again.values["penetration_m"]  # the file that was written is that run
    assert own <= MOST * least


def costs_in_turn(file: Path, found: Tuned) -> dict[str, float]:
    """Median CPU s per simulated s of the chosen setting and its rivals, run in rounds."""
    chosen = found.chosen
    assert chosen is not None
    meeting = sorted((c for c in found.candidates if c.meets(found.bound)), key=lambda c: c.cost)
    runners = [c for c in meeting if c is not chosen and c.cost <= NEAR * chosen.cost][:RIVALS]
    rounds = int(SPENT_S / max(chosen.cost * engine.load_scene(file).duration_s, 1e-3))
    costs: dict[str, list[float]] = {}
    for _ in range(min(max(rounds, LEAST_ROUNDS), MOST_ROUNDS)):
        for candidate in (chosen, *runners):
            costs.setdefault(candidate.setting, []).append(cost_of(file, candidate))
    return {name: median(values) for name, values in costs.items()}


def cost_of(file: Path, candidate: Candidate) -> float:
    run: Any = engine.simulate(file, candidate.overrides, num_threads=1)
    return float(run.summary["cpu_s_per_sim_s"])


def least_words(found: Tuned) -> str:
    """What came nearest where nothing met the bound."""
    kind = found.bound.kind
    return f"nothing meets {kind} {found.bound.most:g}: " + "; ".join(
        f"{c.setting} {c.failed or c.values.get(kind)}" for c in found.candidates
    )
