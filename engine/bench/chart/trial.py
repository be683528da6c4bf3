# SPDX-License-Identifier: MIT
"""One finished run, of whichever engine, and what of it is an error."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from verisim.pose_log import PoseLog

Scene = dict[str, Any]


@dataclass(frozen=True)
class Trial:
    """Poses and the scene they are of; nothing that one engine alone can tell."""

    poses: PoseLog
    scene: Scene  # as read from the file, overrides applied
    folder: Path  # that meshes are relative to

    def body(self, name: str) -> dict[str, Any]:
        return next(body for body in self.scene["bodies"] if body["name"] == name)

    def free_bodies(self) -> list[int]:
        """Indices into the pose log of the bodies that forces move."""
        fixed = {
            body["name"] for body in self.scene["bodies"] if body.get("motion", "free") != "free"
        }
        return [i for i, name in enumerate(self.poses.names) if name not in fixed]

    @property
    def gravity(self) -> float:
        """Magnitude, m/s2."""
        return float(np.linalg.norm(self.scene.get("gravity_m_s2", (0, 0, -9.81))))

    def friction(self, material: str) -> float:
        return float(self.scene["materials"][material].get("friction", 0.5))

    def restitution(self, material: str) -> float:
        return float(self.scene["materials"][material].get("restitution", 0.5))


@dataclass(frozen=True)
class Measure:
    """A quantity that is 0 for a run without error; or, if `is_own`, one whose relative distance
    from that of the contestant's own finest run is the error."""

    key: str  # column of the CSV
    label: str  # axis of the figure, with its unit
    reference: str  # what it is an error against, for people
    evaluate: Callable[[Trial], float]
    lost_above: float = float("inf")  # beyond it the run has failed at what the scene asks
    lost_words: str = ""
    is_own: bool = False
