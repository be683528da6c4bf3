# SPDX-License-Identifier: MIT
"""How far a run strays from its reference: the distance between centres of mass."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

import numpy as np
from ruamel.yaml import YAML

if TYPE_CHECKING:
    from verisim.pose_log import PoseLog


def trajectory_error(run: PoseLog, reference: PoseLog, bodies: Collection[str]) -> float | None:
    """Root mean square over times and bodies of the centre-of-mass distance, m.

    Over the times that both logs hold (a failed run ends early). None when they share no time or
    no body.
    """
    times = min(run.time_s.size, reference.time_s.size)
    shared = [name for name in run.names if name in bodies and name in reference.names]
    if times == 0 or not shared:
        return None
    if not np.allclose(run.time_s[:times], reference.time_s[:times], rtol=0, atol=1e-9):
        return None  # sampled at other times
    own = run.position_m[:times, [run.names.index(name) for name in shared]]
    theirs = reference.position_m[:times, [reference.names.index(name) for name in shared]]
    squared = np.sum((own - theirs) ** 2, axis=2)
    return float(np.sqrt(np.mean(squared)))


def free_bodies(scene_yaml: str) -> list[str]:
    """Names of the bodies that forces move, from a scene as run."""
    document = YAML(typ="safe", pure=True).load(scene_yaml)
    return [b["name"] for b in document["bodies"] if b.get("motion", "free") == "free"]
