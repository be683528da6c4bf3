# SPDX-License-Identifier: MIT
"""What one sweep per substep makes of a column: method xpbd in one dimension."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from verisim.bench.stability.limits import GRAVITY

JITTER = 0.1  # of sqrt(g mean overlap): the engine's `jitters`


@dataclass(frozen=True)
class Settling:
    deepest_m: float
    rings: bool


def sweep_depth(carried: float, step: float) -> float:
    """Overlap (m) of two bodies at rest where the upper one carries `carried` times the lower's
    mass: a sweep pushes the lower one out of the upper by carried g h^2 / 2, and starts from what
    the last one left. Derived here from the recursion below; it is 0 for a body alone.
    """
    return carried * GRAVITY * step**2 / 2


def settle(masses: tuple[float, ...], step: float, duration: float, frame: float) -> Settling:
    """The vertical motion of a column from rest without overlap, bottom first (kg, s).

    A substep: half a kick, drift, one Gauss-Seidel sweep over overlaps, half a kick, one sweep over
    velocities that starts from the loads of the first; loads never pull. Source: Mueller et al.
    2020, with the kick split in two (engine/README.md, method xpbd).
    """
    count = len(masses)
    inverse = [1 / mass for mass in masses]
    # In the engine's order: a body with the next, before the lowest with the floor.
    contacts = [(low, low + 1) for low in range(count - 1)]
    contacts.insert(1 if contacts else 0, (-1, 0))
    place, speed = [0.0] * count, [0.0] * count
    deepest, overlaps, squares, late = 0.0, 0.0, np.zeros(count), 0
    steps = math.ceil(duration / step - 1e-9)
    per_frame = max(1, round(frame / step))
    num_overlaps = 0
    for number in range(1, steps + 1):
        speed = [v - GRAVITY * step / 2 for v in speed]
        place = [z + step * v for z, v in zip(place, speed, strict=True)]
        loads = []
        for low, high in contacts:
            depth = (place[low] if low >= 0 else 0.0) - place[high]
            weight = (inverse[low] if low >= 0 else 0.0) + inverse[high]
            load = max(0.0, depth / weight)
            loads.append(load / step)
            _push(place, low, high, load, inverse)
            _push(speed, low, high, load / step, inverse)
        speed = [v - GRAVITY * step / 2 for v in speed]
        for (low, high), load in zip(contacts, loads, strict=True):
            if load > 0:
                _push(speed, low, high, load, inverse)  # the other half of the kick asks the same
        for (low, high), load in zip(contacts, loads, strict=True):
            if load <= 0:
                continue
            closing = (speed[low] if low >= 0 else 0.0) - speed[high]
            weight = (inverse[low] if low >= 0 else 0.0) + inverse[high]
            _push(speed, low, high, max(-2 * load, closing / weight), inverse)
        depths = [(place[low] if low >= 0 else 0.0) - place[high] for low, high in contacts]
        deepest = max(deepest, *depths)
        if deepest > 1e3 or not math.isfinite(deepest):
            return Settling(math.inf, True)
        if 2 * number > steps:
            overlaps += sum(max(0.0, depth) for depth in depths)
            num_overlaps += len(depths)
            if number % per_frame == 0:
                squares += np.square(speed)
                late += 1
    fastest = math.sqrt(float(squares.max()) / max(1, late))
    mean = overlaps / max(1, num_overlaps)
    return Settling(deepest, fastest > JITTER * math.sqrt(GRAVITY * mean))


def _push(rate: list[float], low: int, high: int, load: float, inverse: list[float]) -> None:
    rate[high] += load * inverse[high]
    if low >= 0:
        rate[low] -= load * inverse[low]
