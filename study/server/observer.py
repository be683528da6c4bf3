# SPDX-License-Identifier: MIT
"""A scripted rater: how visible a clip's fault is, and what an observer with known traits feels."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from verisim.study.problems import refuse
from verisim.study.server.achieved import achieved_level
from verisim.study.server.questions import Percept
from verisim.study.server.samplers.tracks import Track
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


def manipulation(stimulus: Stimulus, tracks: Sequence[Track]) -> tuple[str, float] | None:
    """Returns the track that a clip belongs to and the magnitude it achieved; None for others."""
    for track in tracks:
        if track.scene not in (None, stimulus.scene) or stimulus.role != "test":
            continue
        level = achieved_level(stimulus, track.factor)
        if level is None or (track.scale == "ratio" and level <= 0):
            continue
        magnitude = track.magnitude(level)
        if magnitude > 1e-9:
            return track.name, magnitude
    return None


@dataclass(frozen=True)
class Traits:
    """What the raters of a simulation have in common; each varies about it."""

    bias: float = 0.0  # added to every judgement
    sensitivity: float = 1.0  # 1: sees the visible error as it is; 0: sees none
    noise: float = 0.1  # standard deviation of one judgement
    lapse: float = 0.02  # share of judgements made at random
    spread: float = 1.0  # of bias and sensitivity between raters; 0: all alike
    side_bias: float = 0.0  # towards the second or right clip of a pair
    false_alarm: float = 0.05  # share of flawless clips in which a fault is "seen"
    slope: float = 0.15  # of the psychometric function, on the axis of log10(magnitude)
    thresholds: dict[str, float] = field(default_factory=dict)  # by track; median magnitude


@dataclass(frozen=True)
class Observer:
    """One scripted rater. Sees what a clip achieved, never its level, its name or its cost."""

    bias: float
    sensitivity: float
    noise: float
    lapse: float
    side_bias: float
    false_alarm: float
    slope: float
    thresholds: dict[str, float]

    @classmethod
    def draw(cls, rng: random.Random, traits: Traits | None = None) -> Observer:
        """Draws a rater about the common traits: bias N(0, 0.06), sensitivity log-normal."""
        traits = traits or Traits()
        return cls(
            bias=traits.bias + traits.spread * rng.gauss(0, 0.06),
            sensitivity=traits.sensitivity * math.exp(traits.spread * rng.gauss(0, 0.25)),
            noise=traits.noise * rng.uniform(0.6, 1.4),
            lapse=traits.lapse,
            side_bias=traits.side_bias,
            false_alarm=traits.false_alarm,
            slope=traits.slope,
            thresholds={
                name: value * 10 ** (traits.spread * rng.gauss(0, 0.08))
                for name, value in sorted(traits.thresholds.items())
            },
        )

    def feel(self, error: float, rng: random.Random) -> float:
        """Returns the felt quality of a clip, 0 to 1, for one question."""
        if rng.random() < self.lapse:
            return rng.random()
        felt = 0.9 - 0.8 * self.sensitivity * error + self.bias + rng.gauss(0, self.noise)
        return min(1.0, max(0.0, felt))

    def chance_to_notice(self, error: float, manipulated: tuple[str, float] | None) -> float:
        """Returns the probability of seeing a fault; a known threshold counts before the error."""
        if manipulated is not None and manipulated[0] in self.thresholds:
            track, magnitude = manipulated
            z = (math.log10(magnitude) - math.log10(self.thresholds[track])) / self.slope
        else:
            z = (self.sensitivity * error - 0.4) / 0.15
        seen = 0.5 * (1 + math.erf(z / math.sqrt(2)))
        return self.false_alarm + (1 - self.false_alarm - self.lapse) * seen

    def perceive(
        self,
        clips: Sequence[tuple[float, tuple[str, float] | None]],
        duration_ms: float,
        rng: random.Random,
    ) -> Percept:
        """clips: visible error and manipulation of each clip, in the order shown."""
        return Percept(
            qualities=tuple(self.feel(error, rng) for error, _ in clips),
            noticed=tuple(rng.random() < self.chance_to_notice(*clip) for clip in clips),
            duration_ms=duration_ms,
            lean=self.side_bias,
        )

    def describe(self) -> dict[str, Any]:
        """Returns the traits, one number each, for the event that is stored with the data."""
        numbers = {k: v for k, v in asdict(self).items() if k != "thresholds"}
        numbers |= {f"threshold_{name}"[:40]: value for name, value in self.thresholds.items()}
        return {name: round(value, 4) for name, value in numbers.items()}


def read_thresholds(texts: Sequence[str]) -> dict[str, float]:
    """['gravity_up=0.4'] → {'gravity_up': 0.4}. Raises StudyError for anything else."""
    thresholds: dict[str, float] = {}
    for text in texts:
        name, _, number = text.partition("=")
        try:
            thresholds[name] = float(number)
        except ValueError:
            thresholds[name] = math.nan
        if not name or not thresholds[name] > 0:
            raise refuse("threshold", f"{text!r} is not allowed", "write e.g. gravity_up=0.4")
    return thresholds
