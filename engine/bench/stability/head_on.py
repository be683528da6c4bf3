# SPDX-License-Identifier: MIT
"""A particle that hits a fixed one or a plane head on: the steps of method seed, in one dimension.

v += dt F(x, v) / m;  x += dt v, with F = k overlap - c x' while the overlap is positive: the whole
method for one contact, so its outcome is known without the engine.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

MAX_STEPS = 100_000


@dataclass(frozen=True)
class Passage:
    """What became of the particle."""

    speed: float  # m/s at the end, positive away from where it came
    ends_beyond: bool
    deepest: float  # m, overlap at any step


def pass_wall(
    mass: float, speed: float, stiffness: float, reach: float, dt: float, phase: float
) -> Passage:
    """A particle flies at a fixed one: contact while the centres are closer than `reach` (m).

    It starts `phase` steps short of touching. Undamped.
    """
    x, v, deepest = -reach - phase * speed * dt, speed, 0.0
    for _ in range(MAX_STEPS):
        x += dt * v
        overlap = reach - abs(x)
        if overlap > 0:
            deepest = max(deepest, overlap)
            v += dt * math.copysign(stiffness * overlap, x) / mass
        elif (x > 0) == (v > 0):
            return Passage(v, x > 0, deepest)
    return Passage(v, x > 0, deepest)


def bounce_restitution(damping_ratio: float, steps_per_contact: float, phase: float) -> float:
    """Speed after over speed before of a ball on a plane; mass, stiffness and speed are 1.

    steps_per_contact: elastic contact time pi over the step. phase: steps short of touching.
    """
    dt = math.pi / steps_per_contact
    x, v = phase * dt, -1.0
    for _ in range(MAX_STEPS):
        x += dt * v
        if x < 0:
            v += dt * (-x - 2 * damping_ratio * v)
        elif v > 0:
            return v
    return math.inf
