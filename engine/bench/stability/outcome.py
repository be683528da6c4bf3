# SPDX-License-Identifier: MIT
"""One rule from a run to its outcome: the engine's failure first, the pose log where that is mute.

1. The engine's first failure gives the code: nonfinite, energy_gain X; penetration, sank S;
   pass_through P; toppled T; drifted D; jitters J.
2. A column's failure may be the effect of a blow-up: it counts as X if within five steps after it
   the bodies show more kinetic and potential energy than all there was at the start, by 5 % of
   what lifts them by an edge. `penetration` counts as D if a body is off its place by then, by a
   tenth of an edge.
3. At a wall the ball's own end counts: P if it ends beyond, X if it leaves with 5 % more energy.
4. At a bounce that did not fail: E if the restitution is off by more than 0.02.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from verisim.bench.stability.cells import HOLDS, Judge
from verisim.bench.stability.limits import GRAVITY
from verisim.engine import Run

CODE_OF = {
    "nonfinite": "X",
    "energy_gain": "X",
    "penetration": "S",
    "sank": "S",
    "pass_through": "P",
    "toppled": "T",
    "drifted": "D",
    "jitters": "J",
}
GAIN = 0.05
AFTER_STEPS = 5
ASIDE = 0.1  # of an edge
WRONG = 0.02


@dataclass(frozen=True)
class Outcome:
    code: str
    engine_code: str  # empty where the engine reports no failure
    time_s: float | None
    message: str
    steps: int
    dt_s: float
    cpu_s: float
    max_penetration_m: float
    restitution: float | None  # speed after over speed before, of a lone ball


def judge(run: Run, rule: Judge) -> Outcome:
    summary = run.summary
    failed = summary["failed"]
    restitution = None
    code = CODE_OF[failed["code"]] if failed else HOLDS
    if failed and rule.kind == "column":
        code = _cause(run, rule, failed, code)
    if rule.kind == "wall":
        code = _end_at_wall(run, code)
    if rule.kind == "bounce":
        speed = run.poses.linear_velocity_m_s[:, 0, 2]
        restitution = float(speed[-1] / -speed[0])
        if code == HOLDS and not abs(restitution - rule.restitution) <= WRONG:
            code = "E"
    return Outcome(
        code,
        failed["code"] if failed else "",
        failed["time_s"] if failed else None,
        failed["message"] if failed else "",
        summary["steps"],
        summary["dt_s"],
        summary["cpu_s"],
        summary["metrics"]["max_penetration_m"],
        restitution,
    )


def _cause(run: Run, rule: Judge, failed: dict[str, Any], code: str) -> str:
    poses, summary = run.poses, run.summary
    begin = int(np.searchsorted(poses.time_s, failed["time_s"]))
    window = failed["time_s"] + AFTER_STEPS * summary["dt_s"]
    end = max(int(np.searchsorted(poses.time_s, window)), begin) + 1
    samples = slice(min(begin, len(poses.time_s) - 1), end)
    energy, lift = _seen_energy(run, samples, rule.size_m)
    if not energy <= summary["metrics"]["energy_start_j"] + GAIN * lift:
        return "X"
    moved = poses.position_m[samples, :, :2] - poses.position_m[0, :, :2]
    is_aside = np.linalg.norm(moved, axis=-1).max() > ASIDE * rule.size_m
    return "D" if is_aside and failed["code"] == "penetration" else code


def _seen_energy(run: Run, samples: slice, edge: float) -> tuple[float, float]:
    """Most kinetic energy of flight plus potential energy of all bodies (J), less than what there
    is, since springs and spin are left out; and what lifts all by an edge."""
    mass = np.array([body["mass_kg"] for body in run.summary["bodies"]])
    speed = run.poses.linear_velocity_m_s[samples]
    height = run.poses.position_m[samples, :, 2]
    energy = (mass * (0.5 * (speed**2).sum(axis=-1) + GRAVITY * height)).sum(axis=-1)
    return float(energy.max()), float(mass.sum() * GRAVITY * edge)


def _end_at_wall(run: Run, code: str) -> str:
    place, speed = run.poses.position_m[:, 1, 2], run.poses.linear_velocity_m_s[:, 1, 2]
    if place[-1] < 0:
        return "P"
    return "X" if speed[-1] ** 2 > (1 + GAIN) * speed[0] ** 2 else code
