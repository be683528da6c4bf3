# SPDX-License-Identifier: MIT
"""What the end of an impact on something at rest is judged by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from drops import Outcome

AT_REST_M_S = 1e-3


@dataclass
class Impact:
    """One run; targets: no failure, no rise of energy, rest within 4 s."""

    outcome: Outcome
    rest_s: float = float("inf")  # since when no box moves
    rise_rel: float = 0  # largest rise of energy that nothing put in, of the energy at work
    gained_rel: float = 0  # energy at the end less that at the start, of the same

    def __str__(self) -> str:
        metrics = self.outcome.metrics
        if not metrics:
            return str(self.outcome)
        return (
            f"{self.outcome}; at rest since {self.rest_s:.2f} s, rise {self.rise_rel:.1e}, gained "
            f"{self.gained_rel:.1e}, deepest {1e3 * metrics['max_penetration_m']:.4f} mm, linear "
            f"and angular momentum {metrics['momentum_residual_rel']:.1e} "
            f"{metrics['angular_momentum_residual_rel']:.1e}"
        )


def judge(outcome: Outcome) -> Impact:
    """A ball that rolls away never rests (nothing resists rolling): boxes are judged alone, where
    the ball leaves."""
    if outcome.poses is None:
        return Impact(outcome)
    poses, metrics = outcome.poses, outcome.metrics
    counts = [not (name == "ball" and "into" in outcome.name) for name in poses.names]
    speed = np.linalg.norm(poses.linear_velocity_m_s[:, counts], axis=-1).max(axis=1)
    moving = np.flatnonzero(speed > AT_REST_M_S)
    last = int(moving[-1]) if moving.size else -1
    rest = float("inf") if last + 1 == speed.size else float(poses.time_s[last + 1])
    scale = metrics["energy_scale_j"]
    gained = (metrics["energy_end_j"] - metrics["energy_start_j"]) / scale
    return Impact(outcome, rest, metrics["energy_rise_j"] / scale, gained)
