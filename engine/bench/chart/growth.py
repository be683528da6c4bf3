# SPDX-License-Identifier: MIT
"""How the cost of a pile grows with the number of its boxes: a line per contestant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from verisim.bench.chart.front import Point
from verisim.bench.chart.written_points import Points

PILES = {250: "pile_250", 1000: "pile_1000", 4000: "pile_4000"}  # boxes -> scene, all at rest
DEPTH = "mean_depth_m"


@dataclass(frozen=True)
class Growth:
    """One contestant at one setting."""

    method: str
    setting: str
    costs: dict[int, float]  # boxes -> CPU s per simulated s
    depth_m: float  # mean overlap in the largest of its piles

    @property
    def exponent(self) -> float:
        """Of boxes, by least squares in logarithms."""
        slope, _ = np.polyfit(np.log(list(self.costs)), np.log(list(self.costs.values())), 1)
        return float(slope)


def growths(points: Points) -> list[Growth]:
    """Every contestant at the setting that got through most piles, the cheapest of these in the
    largest of them; none for who got through fewer than two."""
    by_size = {count: points.get((scene, DEPTH), []) for count, scene in PILES.items()}
    settings: dict[str, dict[str, dict[int, Point]]] = {}
    for count, some in by_size.items():
        for point in some:
            if point.counts:
                settings.setdefault(point.method, {}).setdefault(point.setting, {})[count] = point
    found = []
    for method, of in settings.items():
        setting = min(of, key=lambda name: _preference(of[name]))
        piles = of[setting]
        if len(piles) >= 2:
            costs = {count: point.cost for count, point in piles.items()}
            found.append(Growth(method, setting, costs, piles[max(piles)].error))
    return found


def _preference(piles: Mapping[int, Point]) -> tuple[int, float]:
    return -len(piles), piles[max(piles)].cost


def sizes(lines: Sequence[Growth]) -> list[int]:
    """Numbers of boxes that any line has."""
    return [count for count in PILES if any(count in line.costs for line in lines)]


def exponent_words(line: Growth) -> str:
    """As 1.07; of two piles alone in brackets."""
    value = f"{line.exponent:.2f}"
    return value if len(line.costs) > 2 else f"({value})"
