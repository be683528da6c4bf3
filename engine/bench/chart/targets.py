# SPDX-License-Identifier: MIT
"""The project's targets of speed and accuracy beside what the tables of a folder say of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from verisim.bench.chart.against_seed import DEM, LEAST_RATIO, SCENES, comparisons
from verisim.bench.chart.front import Point, cheapest_within, front, is_tie, ties
from verisim.bench.chart.ladder import LADDERS
from verisim.bench.chart.written_points import Points

Verdict = Literal["met", "tie", "not met", "not measured"]
ORDER: tuple[Verdict, ...] = ("not met", "tie", "met")  # the worst first
FEW_BODIES = {  # scene -> its measure
    "drop": "height_error_m",
    "bounce": "apex_error_rel",
    "incline_stick": "drift_m",
    "incline_slip": "way_error_rel",
    "free_spin": "orientation_error_rad",
    "tower_5": "deepest_m",
    "tower_10": "deepest_m",
    "tower_20": "deepest_m",
    "mass_ratio_100": "deepest_m",
    "mass_ratio_1000": "deepest_m",
    "mass_ratio_10000": "deepest_m",
}
EXACT_FOR_OTHERS = {
    "rolling": "way_error_rel",
    "cradle": "speed_error_rel",
    "oblique_slide": "impact_error_rel",
    "oblique_stick": "impact_error_rel",
}
LEVELS = (1e-2, 1e-3, 1e-4)  # of error
EXACT, ALLOWED = 1e-5, 1e-3  # what an engine that is exact by construction reaches; what we may err
OURS = tuple(ladder.key for ladder in LADDERS)
REAL_TIME, CROWD = "real_time", 100
MEAN, DEEPEST = "mean_depth_m", "deepest_m"


@dataclass(frozen=True)
class Target:
    """One line of the table."""

    scene: str
    asked: str
    measured: str
    verdict: Verdict


@dataclass(frozen=True)
class Against:
    """A pile that is to cost less than another engine's at less depth."""

    scene: str
    peer: str
    cost: float  # largest share of the peer's
    mean: float  # of its mean depth
    deepest: float

    @property
    def asked(self) -> str:
        return (
            f"of {self.peer} at most {_share(self.cost)} of the cost, {_share(self.mean)} of the "
            f"mean depth, {_share(self.deepest)} of the deepest"
        )


PILES = (
    Against("pile_1000", "rapier-stiff", 1 / 2, 1 / 2, 1 / 10),
    Against("pile_1000", "mujoco-default", 1 / 20, 1, 1),
    Against("tumbled_1000_rest", "rapier-stiff", 2 / 3, 1 / 4, 1 / 10),
)
ON_THE_FRONT = ("tumbled_100", "pile_4000", "stones_100")


def targets(points: Points, crowds: Sequence[Mapping[str, str]]) -> list[Target]:
    """Every target that the tables of charts, and of bodies in real time, can judge."""
    return [
        *(_few_bodies(scene, points.get((scene, key), [])) for scene, key in FEW_BODIES.items()),
        *(_exact(scene, points.get((scene, key), [])) for scene, key in EXACT_FOR_OTHERS.items()),
        *(_pile(against, points) for against in PILES),
        *(_on_front(scene, points.get((scene, MEAN), [])) for scene in ON_THE_FRONT),
        *(_over_seed(scene, points) for scene in SCENES),
        _in_real_time(crowds),
    ]


# Few bodies.


def _few_bodies(scene: str, points: Sequence[Point]) -> Target:
    asked = "at errors of 1e-2 to 1e-4 no other engine is as cheap"
    ours, others = _sides(points)
    if not ours or not others:
        return Target(scene, asked, "", "not measured")
    between = [point.error for point in front(others) if LEVELS[-1] <= point.error <= LEVELS[0]]
    found = [_level(level, ours, others) for level in sorted({*LEVELS, *between}, reverse=True)]
    verdict, ratio, words = min(found, key=lambda each: (ORDER.index(each[0]), -each[1]))
    if ratio == 0:
        words = f"no other engine reaches {LEVELS[0]:g}"
        if cheapest_within(ours, LEVELS[-1]) is None:
            words += f", and none of ours {LEVELS[-1]:g}"
    return Target(scene, asked, words, verdict)


def _level(
    level: float, ours: Sequence[Point], others: Sequence[Point]
) -> tuple[Verdict, float, str]:
    """At a level of error: verdict, ratio of costs and its words."""
    own, other = cheapest_within(ours, level), cheapest_within(others, level)
    if other is None:
        return "met", 0.0, ""
    if own is None:
        return "not met", math.inf, f"none of ours reaches {level:.1g}; {_at(other)}"
    ratio = own.cost / other.cost
    words = f"at {level:.1g} {own.method} costs {ratio:.2g} of {_at(other)}"
    return _cheaper(own, other), ratio, words


def _cheaper(own: Point, other: Point) -> Verdict:
    if own.cost <= other.cost:
        return "met"
    return "tie" if is_tie(own, other) else "not met"


def _exact(scene: str, points: Sequence[Point]) -> Target:
    asked = f"error of at most {ALLOWED:g} at no more than an engine costs that is exact here"
    ours, others = _sides(points)
    if not ours or not others:
        return Target(scene, asked, "", "not measured")
    other = cheapest_within(others, EXACT)
    if other is None:
        return _few_bodies(scene, points)  # none is exact by construction
    own = cheapest_within(ours, ALLOWED)
    if own is None:
        return Target(scene, asked, f"none of ours reaches {ALLOWED:g}; {_at(other)}", "not met")
    ratio = own.cost / other.cost
    verdict: Verdict = "met" if ratio <= 1 else "tie" if is_tie(own, other) else "not met"
    words = (
        f"{own.method}, {own.setting}: {own.error:.1g} at {ratio:.2g} of the cost of {_at(other)}"
    )
    return Target(scene, asked, words, verdict)


# Piles.


def _pile(against: Against, points: Points) -> Target:
    mean, deepest = (points.get((against.scene, key), []) for key in (MEAN, DEEPEST))
    depth = {(point.method, point.setting): point.error for point in deepest}
    own = [point for point in mean if point.method in OURS and point.counts]
    peers = [point for point in mean if point.method == against.peer and point.counts]
    if not peers or not any(point.method in OURS for point in mean):
        return Target(against.scene, against.asked, "", "not measured")
    peer = min(peers, key=lambda point: point.cost)
    if not own:
        return Target(against.scene, against.asked, "none of ours ended", "not met")

    def shares(point: Point) -> tuple[float, float, float]:
        return (
            point.cost / peer.cost,
            point.error / peer.error,
            depth[point.method, point.setting] / depth[peer.method, peer.setting],
        )

    most = (against.cost, against.mean, against.deepest)

    def excess(point: Point) -> float:
        """By how much the worst of the three is missed; at most 1: none is."""
        return max(share / allowed for share, allowed in zip(shares(point), most, strict=True))

    best = min(own, key=excess)
    cost, mean_share, deepest_share = shares(best)
    words = (
        f"{best.method}, {best.setting}: {cost:.2g} of the cost, {mean_share:.2g} of the mean and "
        f"{deepest_share:.2g} of the deepest of {_at(peer)}"
    )
    return Target(against.scene, against.asked, words, "met" if excess(best) <= 1 else "not met")


def _on_front(scene: str, points: Sequence[Point]) -> Target:
    asked = "on the front of cost against mean depth"
    ours, others = _sides(points)
    if not ours or not others:
        return Target(scene, asked, "", "not measured")
    counted = [point for point in ours if point.counts]
    if not counted:
        return Target(scene, asked, "none of ours ended", "not met")
    on = [point for point in front(points) if point in counted]
    tied = [point for point in ties(points) if point in counted]
    verdict: Verdict = "met" if on else "tie" if tied else "not met"
    shown = min(on or tied or counted, key=lambda point: point.cost)
    words = f"{shown.method}, {shown.setting}: {1e3 * shown.error:.2g} mm at {shown.cost:.3g} s/s"
    rapier = [point for point in others if point.method.startswith("rapier") and point.counts]
    if rapier:
        words += f", {shown.cost / min(point.cost for point in rapier):.2g} times Rapier's least"
    return Target(scene, asked, words, verdict)


def _over_seed(scene: str, points: Points) -> Target:
    asked = f"dem errs {LEAST_RATIO:g} times less than seed at equal cost"
    found = [each for each in comparisons(points) if each.scene == scene]
    some = points.get((scene, SCENES[scene]), [])
    if not found:
        both = any(p.method == "seed" for p in some) and any(p.method in DEM for p in some)
        words = "no run of seed succeeded" if both else ""
        return Target(scene, asked, words, "met" if both else "not measured")
    worst = min(found, key=lambda each: each.ratio)
    if worst.dem is None:
        words = f"nothing of dem is as cheap as {_at(worst.seed)}"
    else:
        words = f"{worst.ratio:.2g} times less than {_at(worst.seed)}"
    verdict: Verdict = "met" if worst.ratio >= LEAST_RATIO else "not met"
    return Target(scene, asked, words, verdict)


# Real time.


def _in_real_time(crowds: Sequence[Mapping[str, str]]) -> Target:
    asked = f"{CROWD} meshes fall and lie within a sixtieth of a second a frame, drawing off"
    own = [row for row in crowds if (row["method"], row["shape"]) == ("dem", "stones")]
    found = next((row for row in own if int(row["bodies"]) == CROWD), None)
    if found is None:
        return Target(REAL_TIME, asked, "", "not measured")
    if found["failed"]:
        return Target(REAL_TIME, asked, found["failed"], "not met")
    falling, lying = float(found["frame_s"]), float(found["rest_frame_s"])
    words = (
        f"dem: {1e3 * falling:.3g} ms a frame, at rest {1e3 * lying:.3g} ms, "
        f"{int(found['points']) // CROWD} surface samples each"
    )
    return Target(REAL_TIME, asked, words, "met" if max(falling, lying) <= 1 / 60 else "not met")


def _sides(points: Sequence[Point]) -> tuple[list[Point], list[Point]]:
    """Ours, others'."""
    ours = [point for point in points if point.method in OURS]
    return ours, [point for point in points if point.method not in OURS]


def _at(point: Point) -> str:
    return f"{point.method}, {point.setting}"


def _share(value: float) -> str:
    """As 2/3."""
    share = Fraction(value).limit_denominator(100)
    return "all" if share == 1 else str(share)
