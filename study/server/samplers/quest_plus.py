# SPDX-License-Identifier: MIT
"""QUEST+: which stimulus says most about a psychometric function, and what is known of it so far.

Source: A. B. Watson 2017, Journal of Vision 17(3):10. Own implementation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

Array = NDArray[np.float64]
# (stimulus, threshold, slope, guess, lapse) → probability of a yes; arrays broadcast
Psychometric = Callable[[Array, Array, Array, Array, Array], Array]


def weibull_db(x: Array, threshold: Array, slope: Array, guess: Array, lapse: Array) -> Array:
    """Weibull function of a stimulus in dB, e.g. 20 log10(contrast). Watson 2017, eq. 2."""
    strength = np.power(10.0, slope * (x - threshold) / 20.0)
    return 1 - lapse - (1 - guess - lapse) * np.exp(-strength)


def cumulative_normal(x: Array, mean: Array, sd: Array, guess: Array, lapse: Array) -> Array:
    """Cumulative normal from guess to 1 - lapse; on a logarithmic axis it is log-normal."""
    return guess + (1 - guess - lapse) * ndtr((x - mean) / sd)


@dataclass(frozen=True)
class Estimate:
    """Means over the posterior, and the threshold's standard deviation."""

    threshold: float
    threshold_sd: float
    slope: float
    guess: float
    lapse: float


class QuestPlus:
    """Posterior over (threshold, slope, guess, lapse) on a grid, for yes/no outcomes.

    Time and memory grow with the product of all grid sizes; 25 x 4 x 3 x 2 over 10 stimuli takes
    about 0.1 ms per trial.
    """

    def __init__(
        self,
        stimuli: Sequence[float],
        thresholds: Sequence[float],
        slopes: Sequence[float],
        guesses: Sequence[float],
        lapses: Sequence[float],
        function: Psychometric = cumulative_normal,
    ) -> None:
        self.stimuli = np.asarray(stimuli, dtype=np.float64)
        axes = [np.asarray(a, dtype=np.float64) for a in (thresholds, slopes, guesses, lapses)]
        self.grids = [g.ravel() for g in np.meshgrid(*axes, indexing="ij")]
        x = self.stimuli[:, np.newaxis]
        # yes_sp: stimulus x parameters
        self.yes_sp = function(x, *(grid[np.newaxis, :] for grid in self.grids))
        self.posterior_p = np.full(self.grids[0].size, 1 / self.grids[0].size)

    def update(self, stimulus: int, is_yes: bool) -> None:
        """Takes an outcome into account; stimulus: index of the one shown."""
        likelihood = self.yes_sp[stimulus] if is_yes else 1 - self.yes_sp[stimulus]
        posterior = self.posterior_p * likelihood
        total = posterior.sum()
        if total > 0:  # an outcome that every parameter forbids says nothing about them
            self.posterior_p = posterior / total

    def expected_entropy(self) -> Array:
        """Returns, per stimulus, the entropy (nats) to be expected after showing it. Eq. 6–8."""
        expected = np.zeros(self.stimuli.size)
        for likelihood_sp in (self.yes_sp, 1 - self.yes_sp):
            joint_sp = likelihood_sp * self.posterior_p
            chance_s = joint_sp.sum(axis=1)
            with np.errstate(divide="ignore", invalid="ignore"):
                log_sp = np.where(joint_sp > 0, np.log(joint_sp), 0.0)
                log_s = np.where(chance_s > 0, np.log(chance_s), 0.0)
            expected -= (joint_sp * log_sp).sum(axis=1) - chance_s * log_s
        return expected

    def next_stimulus(self) -> int:
        """Returns the stimulus with the least expected entropy, by index; the first of equals."""
        return int(np.argmin(self.expected_entropy()))

    def estimate(self) -> Estimate:
        threshold, slope, guess, lapse = (float(g @ self.posterior_p) for g in self.grids)
        variance = float(((self.grids[0] - threshold) ** 2) @ self.posterior_p)
        return Estimate(threshold, math.sqrt(max(variance, 0.0)), slope, guess, lapse)

    def mode(self) -> tuple[float, float, float, float]:
        """Returns the most probable parameters: threshold, slope, guess, lapse."""
        best = int(np.argmax(self.posterior_p))
        threshold, slope, guess, lapse = (float(grid[best]) for grid in self.grids)
        return threshold, slope, guess, lapse
