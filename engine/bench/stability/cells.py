# SPDX-License-Identifier: MIT
"""What a stability map is made of: methods, cells, their scenes and predictions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

HOLDS = "ok"
CODES = {
    "ok": "holds",
    "X": "blows up: not finite, or energy from nowhere",
    "S": "sinks: deeper than half a particle, or than 5 % of the body",
    "T": "topples: tilts by more than 0.1 rad",
    "D": "drifts: leaves its place, or 1 % of its size per 10 s",
    "J": "jitters: does not come to rest",
    "P": "passes through",
    "E": "wrong restitution: off by more than 0.02",
    "?": "not finished: too slow, or the engine broke down",
}
METHODS = {
    "seed": {"method": "seed"},
    "dem-explicit": {"method": "dem", "integrator": "explicit"},
    "dem-hybrid": {"method": "dem", "integrator": "hybrid"},
    "xpbd": {"method": "xpbd"},
}
SPRINGS = tuple(name for name in METHODS if name != "xpbd")  # whose contacts are springs
Scene = dict[str, Any]


@dataclass(frozen=True)
class Judge:
    """What of a run counts, beside the engine's own failure codes."""

    kind: str  # column | wall | bounce | landing
    size_m: float = 1.0  # edge of a body; of the wall, where its far side is
    restitution: float = 1.0


@dataclass(frozen=True)
class Pose:
    """A cell as a scene to run."""

    scene: Scene
    judge: Judge
    sample_interval_s: float


@dataclass(frozen=True)
class Prediction:
    """Outcomes that the theory allows, one code or two of one cause, and which limit says so."""

    codes: tuple[str, ...]
    limit: str
    value: float  # the quantity that the limit is about, 1 = at the limit where it is a ratio

    @property
    def words(self) -> str:
        return "/".join(self.codes)


@dataclass(frozen=True)
class Line:
    """A published or derived limit to draw over a map: y for each x, in the map's own units."""

    label: str
    x: tuple[float, ...]
    y: tuple[float, ...]


@dataclass(frozen=True)
class Grid:
    x: tuple[float, ...]
    y: tuple[float, ...]


@dataclass(frozen=True)
class StabilityMap:
    """One map of one method."""

    key: str
    method: str
    title: str
    x_label: str
    y_label: str
    full: Grid
    quick: Grid
    pose: Callable[[float, float], Pose]
    predict: Callable[[float, float], Prediction]
    lines: Callable[[], list[Line]] = list
    y_names: Callable[[float], str] | None = None  # where rows are not numbers
    note: str = ""

    @property
    def name(self) -> str:
        return f"{self.key}__{self.method}"


def logs(low: float, high: float, count: int) -> tuple[float, ...]:
    """`count` values in equal ratios, rounded to four digits so that files stay readable."""
    return tuple(float(f"{value:.4g}") for value in np.geomspace(low, high, count))


def whole_logs(low: float, high: float, count: int) -> tuple[float, ...]:
    """The same as whole numbers, each once."""
    return tuple(float(v) for v in dict.fromkeys(np.round(np.geomspace(low, high, count))))


def make_scene(
    name: str, duration_s: float, physics: Scene, bodies: list[Scene], **more: Any
) -> Scene:
    """A scene on the ground z = 0 with one material per density. Each body's `density` and the
    common `restitution` and `friction` in `more` become materials."""
    law = {"restitution": more.pop("restitution", 0.5), "friction": more.pop("friction", 0.5)}
    materials = {"floor": {"density_kg_m3": 1000.0, **law}}
    listed = []
    for body in bodies:
        rest = {key: value for key, value in body.items() if key != "density"}
        material = f"of_{body['name']}"
        materials[material] = {"density_kg_m3": body["density"], **law}
        listed.append({**rest, "material": material})
    scene = {
        "schema": 1,
        "name": name,
        "duration_s": duration_s,
        "materials": materials,
        "bodies": listed,
        "physics": physics,
    }
    if more.pop("ground", True):
        plane = {"normal": [0, 0, 1], "offset_m": 0}
        scene["ground"] = {"plane": plane, "material": "floor"}
    return {**scene, **more}
