# SPDX-License-Identifier: MIT
"""Clips and orders made in memory, for tests of designs."""

from __future__ import annotations

import itertools
import tempfile
from pathlib import Path
from typing import Any

from verisim.study.server.samplers import Order, PlannedTrial, participant_seed, plan_order
from verisim.study.server.samplers.read_order import read_order
from verisim.study.server.stimulus_set import Stimulus
from verisim.study.server.yaml_source import Section, YamlSource


def make_stimulus(
    name: str,
    scene: str,
    role: str = "test",
    reference: str = "",
    achieved: dict[str, float] | None = None,
    **factors: str,
) -> Stimulus:
    sidecar: dict[str, Any] = {"achieved": achieved} if achieved else {}
    return Stimulus(
        name, scene, role, "seed", 1, reference, name, "0" * 64, 1, 1, 1, 30.0, 30, 1.0, "",
        factors, sidecar,
    )  # fmt: skip


def crossed(scenes: str, levels: str, factor: str = "level") -> list[Stimulus]:
    """One clip per scene and level (words), the last level being the reference."""
    last = levels.split()[-1]
    return [
        make_stimulus(
            f"{scene}-{level}",
            scene,
            reference="" if level == last else f"{scene}-{last}",
            **{factor: level},
        )
        for scene, level in itertools.product(scenes.split(), levels.split())
    ]


def order_of(text: str) -> Order:
    """Reads the `order` of a study from flow YAML."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "order.yaml"
        path.write_text(f"order: {text}\n")
        source = YamlSource(path)
        order = read_order(Section(source, source.root).section("order"))
        source.raise_problems()
    assert order is not None
    return order


def plan(
    order: Order,
    stimuli: list[Stimulus],
    list_no: int,
    cell: str = "",
    layouts: tuple[str, ...] = ("single",),
) -> list[PlannedTrial]:
    seed = participant_seed(order.seed, list_no, cell)
    return plan_order(order, stimuli, layouts, seed, list_no, cell)
