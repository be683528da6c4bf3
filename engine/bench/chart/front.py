# SPDX-License-Identifier: MIT
"""Points of cost and error: who dominates whom, and what the noise of costs leaves open."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean, median, quantiles, variance

from scipy.stats import t as student

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Point:
    """One setting of one contestant; costs are of its runs, in CPU s per simulated s."""

    method: str
    setting: str
    error: float
    costs: tuple[float, ...]
    failed: str = ""

    @property
    def cost(self) -> float:
        return median(self.costs) if self.costs else math.inf

    @property
    def counts(self) -> bool:
        """Whether it may stand on a front."""
        return not self.failed and bool(self.costs) and math.isfinite(self.error)


def quartiles(costs: Sequence[float]) -> tuple[float, float]:
    if len(costs) < 2:
        return costs[0], costs[0]
    low, _, high = quantiles(costs, n=4, method="inclusive")
    return low, high


def log_ratio_interval(a: Sequence[float], b: Sequence[float]) -> tuple[float, float]:
    """95 % interval of the mean log of cost a over cost b (Welch 1947, unequal variances).

    With fewer than two runs of either nothing is known: (-inf, inf).
    """
    if min(len(a), len(b)) < 2:
        return -math.inf, math.inf
    logs = [[math.log(max(cost, 1e-12)) for cost in costs] for costs in (a, b)]
    difference = fmean(logs[0]) - fmean(logs[1])
    parts = [variance(values) / len(values) for values in logs]
    if sum(parts) == 0:
        return difference, difference
    freedom = sum(parts) ** 2 / sum(
        part**2 / (len(values) - 1) for part, values in zip(parts, logs, strict=True)
    )
    reach = float(student.ppf(0.5 + CONFIDENCE / 2, freedom)) * math.sqrt(sum(parts))
    return difference - reach, difference + reach


def is_tie(a: Point, b: Point) -> bool:
    """Whether the costs cannot be told apart."""
    low, high = log_ratio_interval(a.costs, b.costs)
    return low <= 0 <= high


def dominates(a: Point, b: Point) -> bool:
    """Surely: no larger error, and cheaper beyond the noise."""
    return a.error <= b.error and log_ratio_interval(a.costs, b.costs)[1] < 0


def front(points: Sequence[Point]) -> list[Point]:
    """The points that no other beats in cost and error (medians), by rising cost."""
    best: list[Point] = []
    for point in sorted((p for p in points if p.counts), key=lambda p: (p.cost, p.error)):
        if not best or point.error < best[-1].error:
            best.append(point)
    return best


def ties(points: Sequence[Point]) -> list[Point]:
    """Points beside the front that nothing surely dominates: within the noise they belong to it."""
    on = front(points)
    return [
        point
        for point in points
        if point.counts and point not in on and not any(dominates(other, point) for other in on)
    ]


def cheapest_within(points: Sequence[Point], error: float) -> Point | None:
    """The cheapest point of at most this error."""
    fitting = [point for point in points if point.counts and point.error <= error]
    return min(fitting, key=lambda point: point.cost, default=None)
