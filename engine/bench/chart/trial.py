# SPDX-License-Identifier: MIT
"""One finished run, of whichever engine, and what of it is an error."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from ruamel.yaml import YAML

from verisim.engine import PoseLog

Scene = dict[str, Any]


def scene_document(file: Path) -> Scene:
    """A scene file as read, nothing resolved. Made scenes are JSON, which reads far faster."""
    return _document(file, file.stat().st_mtime_ns)


@lru_cache(maxsize=8)
def _document(file: Path, _mtime_ns: int) -> Scene:
    text = file.read_text("utf-8")
    document: Scene = json.loads(text) if text.startswith("{") else YAML(typ="safe").load(text)
    return document


@dataclass(frozen=True)
class Trial:
    """Poses and the scene they are of; nothing that one engine alone can tell."""

    poses: PoseLog
    scene: Scene  # as read from the file
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
