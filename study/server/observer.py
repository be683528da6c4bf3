# SPDX-License-Identifier: MIT
"""A scripted rater: how visible a clip's fault is, and what an observer with known traits feels."""

from __future__ import annotations

import math
import random
from dataclasses import asdict, dataclass
from typing import Any

from verisim.study.server.stimulus_set import Stimulus

# Half of the observers' full effect is reached at these sizes (m). Chosen, not measured: the demo's
# bodies are 0.1 to 0.3 m, where a sinking of 1 cm and a displacement of 5 cm are plain to see.
HALF_PENETRATION_M = 0.01
HALF_ERROR_M = 0.05


def visible_error(stimulus: Stimulus) -> float:
    """Returns how plainly a clip is wrong, 0 (flawless) to below 1, from its sidecar alone.

    Penetration and distance to the reference run each saturate, x / (x + half), and add up like
    independent chances of being noticed. A failed run and a catch clip, which is built to be
    blatant, count as 0.95. What the clip cost to compute plays no part.
    """
    metrics = stimulus.sidecar.get("metrics") or {}
    unnoticed = 1.0
    for size, half in (
        (metrics.get("max_penetration_m"), HALF_PENETRATION_M),
        (stimulus.sidecar.get("error_to_reference_m"), HALF_ERROR_M),
    ):
        if isinstance(size, int | float) and math.isfinite(size) and size > 0:
            unnoticed *= half / (size + half)
    if stimulus.sidecar.get("failed") or stimulus.role == "catch":
        unnoticed = min(unnoticed, 0.05)
    return 1 - unnoticed


@dataclass(frozen=True)
class Observer:
    """The traits of one scripted rater, all known and stored with the data."""

    bias: float  # added to every judgement
    sensitivity: float  # 1: sees the visible error as it is; 0: sees none
    noise: float  # standard deviation of one judgement
    lapse: float  # share of judgements made at random

    @classmethod
    def draw(cls, rng: random.Random) -> Observer:
        """Draws traits: bias N(0, 0.06), sensitivity log-normal about 1, noise 0.06 to 0.14."""
        return cls(
            bias=rng.gauss(0, 0.06),
            sensitivity=math.exp(rng.gauss(0, 0.25)),
            noise=rng.uniform(0.06, 0.14),
            lapse=0.02,
        )

    def feel(self, error: float, rng: random.Random) -> float:
        """Returns the felt quality of a clip, 0 to 1, for one question."""
        if rng.random() < self.lapse:
            return rng.random()
        felt = 0.9 - 0.8 * self.sensitivity * error + self.bias + rng.gauss(0, self.noise)
        return min(1.0, max(0.0, felt))

    def describe(self) -> dict[str, Any]:
        return {name: round(value, 4) for name, value in asdict(self).items()}
