# SPDX-License-Identifier: MIT
"""What method dem does for no more than method seed costs, on the scenes that the target names."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from verisim.bench.chart.front import Point, front
from verisim.bench.chart.written_points import Points

SCENES = {  # scene -> its measure
    "drop": "height_error_m",
    "bounce": "apex_error_rel",
    "incline_stick": "drift_m",
    "incline_slip": "way_error_rel",
    "tower_5": "deepest_m",
    "tower_10": "deepest_m",
    "tower_20": "deepest_m",
}
DEM = ("dem", "dem-explicit")
LEAST_RATIO = 10.0


@dataclass(frozen=True)
class Comparison:
    """A point of seed's front and the least error of dem that costs no more."""

    scene: str
    seed: Point
    dem: Point | None  # None: nothing of dem is as cheap

    @property
    def ratio(self) -> float:
        """Of the errors, seed's over dem's."""
        if self.dem is None:
            return 0.0
        return self.seed.error / self.dem.error if self.dem.error > 0 else math.inf


def comparisons(points: Points) -> list[Comparison]:
    """Scene by scene, along seed's front."""
    found = []
    for scene, measure in SCENES.items():
        some = points.get((scene, measure), [])
        dem = [point for point in some if point.method in DEM]
        if not dem:
            continue
        for seed in front([point for point in some if point.method == "seed"]):
            found.append(Comparison(scene, seed, least_error_within(dem, seed.cost)))
    return found


def least_error_within(points: Sequence[Point], cost: float) -> Point | None:
    """The point of least error that costs at most so much."""
    fitting = [point for point in points if point.counts and point.cost <= cost]
    return min(fitting, key=lambda point: (point.error, point.cost), default=None)
