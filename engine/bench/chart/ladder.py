# SPDX-License-Identifier: MIT
"""The methods of our engine and the ladder of settings that each climbs: data alone.

A new method is one more `Ladder` in LADDERS.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Times:
    """A multiple of what the engine chooses by itself beside the rung's other settings."""

    factor: float


Value = float | int | str | Times


@dataclass(frozen=True)
class Rung:
    """One setting."""

    name: str
    settings: Mapping[str, Value] = field(default_factory=dict)  # by key of `physics`
    is_quick: bool = False
    is_finest: bool = False  # the method's own reference, where a scene has no closed form


@dataclass(frozen=True)
class Ladder:
    key: str
    label: str
    base: Mapping[str, Value]  # what makes it this method
    rungs: tuple[Rung, ...]


# `dem`: time steps at the penetration it allows by itself; then, at a frame's step and at a long
# one, the penetration allowed and the steps of an impact.
DEM_STEPS = {"1/10": 0.1, "1/30": 1 / 30, "1/60": 1 / 60, "1/240": 1 / 240, "1/1000": 1e-3}
DEM = Ladder(
    "dem",
    "dem",
    {"method": "dem", "integrator": "hybrid"},
    (
        *(
            Rung(f"dt {name}", {"dt_s": dt}, is_quick=name != "1/1000")
            for name, dt in DEM_STEPS.items()
        ),
        Rung("dt 1/10, pen /10", {"dt_s": 0.1, "max_penetration_m": Times(0.1)}, is_quick=True),
        Rung("dt 1/10, pen /100", {"dt_s": 0.1, "max_penetration_m": Times(0.01)}, is_quick=True),
        Rung("dt 1/10, pen x10", {"dt_s": 0.1, "max_penetration_m": Times(10)}, is_quick=True),
        Rung("dt 1/60, pen /10", {"dt_s": 1 / 60, "max_penetration_m": Times(0.1)}),
        Rung("dt 1/60, pen /100", {"dt_s": 1 / 60, "max_penetration_m": Times(0.01)}),
        Rung("dt 1/60, pen x10", {"dt_s": 1 / 60, "max_penetration_m": Times(10)}),
        Rung(
            "dt 1/10, 20 steps, pen x10",
            {"dt_s": 0.1, "steps_per_contact": 20, "max_penetration_m": Times(10)},
            is_quick=True,
        ),
        Rung("dt 1/4, pen x4", {"dt_s": 0.25, "max_penetration_m": Times(4)}, is_quick=True),
        Rung("dt 1/4, pen /10", {"dt_s": 0.25, "max_penetration_m": Times(0.1)}, is_quick=True),
        Rung("dt 1/30, pen x10", {"dt_s": 1 / 30, "max_penetration_m": Times(10)}),
        Rung("dt 1/60, 20 steps", {"dt_s": 1 / 60, "steps_per_contact": 20}, is_quick=True),
        Rung("dt 1/10, 20 steps", {"dt_s": 0.1, "steps_per_contact": 20}),
        Rung("dt 1/10, 100 steps", {"dt_s": 0.1, "steps_per_contact": 100}),
        Rung(
            "dt 1/10, 20 steps, pen /100",
            {"dt_s": 0.1, "steps_per_contact": 20, "max_penetration_m": Times(0.01)},
        ),
        Rung(
            "dt 1/240, 100 steps, pen /10",
            {"dt_s": 1 / 240, "steps_per_contact": 100, "max_penetration_m": Times(0.1)},
            is_quick=True,
            is_finest=True,
        ),
    ),
)
EXPLICIT = Ladder(
    "dem-explicit",
    "dem, explicit",
    {"method": "dem", "integrator": "explicit"},
    (
        Rung("20 steps, pen x10", {"steps_per_contact": 20, "max_penetration_m": Times(10)}, True),
        Rung("40 steps, pen x10", {"steps_per_contact": 40, "max_penetration_m": Times(10)}),
        Rung("20 steps", {"steps_per_contact": 20}, is_quick=True),
        Rung("40 steps", {"steps_per_contact": 40}),
        Rung("100 steps", {"steps_per_contact": 100}, is_finest=True),
    ),
)
# `seed`: its own choice, then stiffer springs (its step shrinks with them), shorter steps, finer
# particles.
SEED = Ladder(
    "seed",
    "seed",
    {"method": "seed"},
    (
        Rung("as it is", {}, is_quick=True),
        Rung("dt x2", {"dt_s": Times(2)}, is_quick=True),
        Rung("dt /2", {"dt_s": Times(0.5)}),
        Rung("stiffness x10", {"stiffness_n_m": Times(10)}, is_quick=True),
        Rung("stiffness x100", {"stiffness_n_m": Times(100)}, is_quick=True, is_finest=True),
        Rung("stiffness x100, dt /4", {"stiffness_n_m": Times(100), "dt_s": Times(0.25)}),
        Rung("stiffness x10000", {"stiffness_n_m": Times(1e4)}),
        Rung("particles /2", {"particle_size_m": Times(0.5)}),
        Rung("rkmk4, stiffness x10", {"integrator": "rkmk4", "stiffness_n_m": Times(10)}),
    ),
)
# `xpbd`: substeps of a frame, and a long frame for what flies, which it does exactly.
XPBD_SUBSTEPS = {5: True, 10: False, 20: True, 40: False, 80: True, 160: False}
XPBD = Ladder(
    "xpbd",
    "xpbd",
    {"method": "xpbd"},
    (
        *(
            Rung(f"{count} substeps", {"substeps": count}, is_quick=is_quick)
            for count, is_quick in XPBD_SUBSTEPS.items()
        ),
        Rung("dt 1/10, 30 substeps", {"dt_s": 0.1, "substeps": 30}, is_quick=True),
        Rung("dt 1/10, 120 substeps", {"dt_s": 0.1, "substeps": 120}),
        Rung("320 substeps", {"substeps": 320}, is_finest=True),
    ),
)
LADDERS = (DEM, EXPLICIT, XPBD, SEED)
