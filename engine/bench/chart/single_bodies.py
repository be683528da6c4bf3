# SPDX-License-Identifier: MIT
"""Bench scenes of a single body or a row: every error is against a closed form."""

from __future__ import annotations

from collections.abc import Callable

from verisim.bench.chart import errors
from verisim.bench.chart.bench_scene import BenchScene
from verisim.bench.chart.trial import Measure, Trial
from verisim.bench.stability.limits import damping_for_restitution

Settings = dict[str, dict[str, float | str]]


def _rebound(restitution: float) -> Settings:
    """Method seed reads no restitution: its dashpot is set to what returns the one meant."""
    damping = damping_for_restitution(restitution) if restitution < 1 else 0.0
    return {"seed": {"physics.damping_ratio": damping}}


# dem's springs give a sticking impact its tangential rebound; the rigid impact has none.
RIGID: Settings = {
    **_rebound(0.8),
    "dem": {"physics.tangential_law": "rigid_stick"},
    "dem-explicit": {"physics.tangential_law": "rigid_stick"},
}


def _measure(
    key: str,
    label: str,
    formula: str,
    evaluate: Callable[[Trial], float],
    lost_above: float = float("inf"),
    lost_words: str = "",
) -> Measure:
    return Measure(key, label, f"closed form: {formula}", evaluate, lost_above, lost_words)


def single_body_scenes() -> list[BenchScene]:
    return [
        BenchScene(
            "drop",
            "A cube falls and stays",
            "A cube falls flat from 1 m; restitution 0.",
            (
                _measure(
                    "height_error_m",
                    "rms error of height (m)",
                    "free fall until it lands, then rest",
                    errors.fall_error,
                ),
            ),
        ),
        BenchScene(
            "bounce",
            "A ball bounces",
            "A ball falls 1 m onto the floor; restitution 0.8. Each top is 0.64 of the last.",
            (
                _measure(
                    "apex_error_rel",
                    "largest relative error of five tops",
                    "tops at h e^(2n) (Newton's restitution)",
                    errors.apex_error,
                    1.0,
                    "bounce lost",
                ),
            ),
            settings=_rebound(0.8),
        ),
        BenchScene(
            "incline_stick",
            "A block sticks on a slope",
            "10 degrees, friction 0.3, for 10 s.",
            (
                _measure(
                    "drift_m",
                    "way down the slope (m)",
                    "none: tan 10° < 0.3 (Coulomb)",
                    errors.drift_error,
                    0.5,
                    "slid off",
                ),
            ),
        ),
        BenchScene(
            "incline_slip",
            "A block slides down a slope",
            "30 degrees, friction 0.3, for 2 s.",
            (
                _measure(
                    "way_error_rel",
                    "relative error of the way slid",
                    "g (sin α − μ cos α) t²/2 (Coulomb)",
                    errors.slide_error,
                ),
                _measure(
                    "lift_m",
                    "farthest off the plane (m)",
                    "none: the block stays on the plane",
                    errors.lift_error,
                ),
            ),
        ),
        BenchScene(
            "rolling",
            "A sliding ball comes to roll",
            "3 m/s without spin, friction 0.3, for 3 s.",
            (
                _measure(
                    "way_error_rel",
                    "relative error of the way gone",
                    "slides until t = 2v/(7 μ g), then rolls at 5v/7",
                    errors.roll_error,
                ),
                _measure(
                    "speed_error_rel",
                    "relative error of the last speed",
                    "5/7 of the first (angular momentum about the contact)",
                    errors.roll_speed_error,
                ),
            ),
        ),
        BenchScene(
            "oblique_slide",
            "An oblique impact that slides",
            "A ball meets the floor at 2 m/s, sliding at 4 m/s; friction 0.2, restitution 0.8.",
            (
                _measure(
                    "impact_error_rel",
                    "worst relative error of speeds and spin",
                    "rigid impact with Coulomb friction (Routh 1860; Walton 1993)",
                    errors.oblique_error,
                ),
            ),
            settings=RIGID,
        ),
        BenchScene(
            "oblique_stick",
            "An oblique impact that sticks",
            "The ball slides at 1 m/s only: friction stops the sliding while it touches. dem runs "
            "with tangential_law rigid_stick, for its springs would give a tangential rebound, "
            "which this reference has not.",
            (
                _measure(
                    "impact_error_rel",
                    "worst relative error of speeds and spin",
                    "rigid impact without tangential rebound (Routh 1860; Walton 1993)",
                    errors.oblique_error,
                ),
            ),
            settings=RIGID,
        ),
        BenchScene(
            "cradle",
            "A cradle with gaps",
            "Five balls 1 mm apart, restitution 1; the first comes at 1 m/s.",
            (
                _measure(
                    "speed_error_rel",
                    "largest error of a ball's speed (of the first's)",
                    "equal masses swap velocities: only the last moves",
                    errors.cradle_error,
                ),
                _measure(
                    "energy_error_rel",
                    "relative error of the energy",
                    "conserved",
                    errors.cradle_energy_error,
                ),
            ),
            settings=_rebound(1),
        ),
        BenchScene(
            "free_spin",
            "A plate spins freely",
            "Moments of inertia 1, 2, 3; 5 rad/s about the middle axis for 20 s.",
            (
                _measure(
                    "orientation_error_rad",
                    "error of orientation after 20 s (rad)",
                    "Euler's equations at eighth order to 1e-13",
                    errors.orientation_error,
                ),
                _measure(
                    "energy_error_rel",
                    "largest relative error of energy",
                    "conserved",
                    errors.spin_energy_error,
                ),
            ),
            not_posed={"seed": "a plate of no thickness cannot be filled with particles"},
        ),
    ]
