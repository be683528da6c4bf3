# SPDX-License-Identifier: MIT
"""All scenes of the chart, chosen by name."""

from __future__ import annotations

from collections.abc import Sequence

from verisim.bench.chart.bench_scene import BenchScene
from verisim.bench.chart.single_bodies import single_body_scenes
from verisim.bench.chart.stacks import stack_scenes
from verisim.bench.problems import BenchError


def all_scenes() -> list[BenchScene]:
    return [*single_body_scenes(), *stack_scenes()]


def choose_scenes(names: Sequence[str] | None) -> list[BenchScene]:
    """The scenes of these names in the catalogue's order; None: all.

    Raises BenchError naming every unknown one.
    """
    every = {scene.key: scene for scene in all_scenes()}
    if problems := [name for name in names or () if name not in every]:
        raise BenchError(
            f"SCENE: saw {', '.join(map(repr, problems))}; allowed: {', '.join(every)}\n"
            "  hint: to choose a setting for a scene of your own, use verisim tune"
        )
    return [scene for key, scene in every.items() if not names or key in names]
