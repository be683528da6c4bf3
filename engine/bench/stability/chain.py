# SPDX-License-Identifier: MIT
"""How deep a column sinks that is let go as it just touches: springs with Hunt-Crossley damping."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from verisim.bench.stability.limits import GRAVITY

STEPS_OF_PERIOD = 200
PERIODS = 3


@cache
def overshoot(masses: tuple[float, ...], damping: float) -> float:
    """Deepest over static overlap of the lowest contact; the bodies move along z alone.

    F = K x (1 + d x'/v0) >= 0 with v0 the fastest approach of that contact so far, at least
    sqrt(g static overlap): the law that engine/README.md states, integrated finely. The ratio
    depends on neither K nor g: lengths scale with the static overlap, times with its root.
    """
    mass = np.array(masses)
    static = 1e-3
    stiffness = GRAVITY * mass.sum() / static
    dt = 2 * math.pi * math.sqrt(mass.min() / stiffness) / STEPS_OF_PERIOD
    slowest = math.pi * math.sqrt(static / GRAVITY) * mass.size
    place, speed = np.zeros(mass.size), np.zeros(mass.size)
    approach = np.full(mass.size, math.sqrt(GRAVITY * static))
    deepest = 0.0
    for _ in range(int(PERIODS * slowest / dt)):
        place += dt * speed
        overlap = -np.diff(place, prepend=0.0)
        closing = -np.diff(speed, prepend=0.0)
        approach = np.maximum(approach, closing)
        push = np.maximum(0.0, stiffness * overlap * (1 + damping * closing / approach))
        push[overlap <= 0] = 0.0
        speed += dt * ((push - np.append(push[1:], 0.0)) / mass - GRAVITY)
        deepest = max(deepest, float(overlap[0]))
    return deepest / static
