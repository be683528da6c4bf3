# SPDX-License-Identifier: MIT
"""Which engines stand beside ours, with which settings, and what each of them cannot pose."""

from __future__ import annotations

from dataclasses import dataclass

from verisim.bench.peers import lammps
from verisim.bench.peers.scene import PeerScene


@dataclass(frozen=True)
class PeerConfig:
    """One engine with one group of settings."""

    engine: str
    config: str

    @property
    def key(self) -> str:
        """For file names and rows, as `mujoco-tuned`."""
        return f"{self.engine}-{self.config}"


# Engine -> configuration -> what it sets. The settings stand in the drivers.
CONFIGS: dict[str, dict[str, str]] = {
    "mujoco": {
        "default": "Euler, Newton, pyramidal cone, solref 0.02 1; with restitution its half "
        "period is 10 steps",
        "tuned": "elliptic cone, impratio 100, noslip 10, 200 iterations to 1e-12, solref 2 steps; "
        "with restitution its half period is 20 steps",
        "tuned+rk4": "tuned, fourth-order Runge-Kutta",
    },
    "bullet": {
        "default": "float32, 10 iterations",
        "tuned": "float64, 100 iterations, restitution threshold 0",
        "restitution": "float64, contact processing threshold 0, no warm start, slop 0, "
        "restitution threshold 0, split impulse always",
    },
    "ode": {
        "20": "QuickStep, 20 iterations, ERP 0.2, CFM 1e-10",
        "100": "QuickStep, 100 iterations, ERP 0.2, CFM 1e-10",
        "dWorldStep": "direct solution of the LCP, CFM 0",
    },
    "jolt": {
        "default": "10 velocity and 2 position steps, damping 0.05, no gyroscopic term, slop 20 mm",
        "tuned": "30 velocity and 10 position steps, slop 0.5 mm, no damping, gyroscopic term, "
        "restitution from 1 mm/s",
    },
    "rapier": {
        "default": "4 iterations, contacts of 30 Hz, of 60 Hz on what is fixed",
        "stiff": "8 iterations, contacts of a quarter of the substep rate, slop 0.1 mm",
        "16it+coulomb": "16 iterations, Coulomb friction, slop 0.1 mm, every contact anew",
    },
    "lammps": {
        "default": "gran/hooke/history, contact of 40 steps",
        "20": "gran/hooke/history, contact of 20 steps",
    },
}
EXPLICIT_PAIRS_UP_TO = 60  # bodies; MuJoCo needs a line per pair of bodies for values by pair


def contestants() -> list[PeerConfig]:
    """Every engine with every group of settings, default first."""
    return [PeerConfig(engine, config) for engine, configs in CONFIGS.items() for config in configs]


def cannot_pose(config: PeerConfig, scene: PeerScene) -> str | None:
    """Why this engine cannot take the scene, as `no tethers`; None if it can."""
    if scene.problems:
        return "no " + ", no ".join(scene.problems)
    if config.engine == "lammps":
        return lammps.cannot_pose(scene)
    many = len(scene.bodies) > EXPLICIT_PAIRS_UP_TO
    if config.engine == "mujoco" and many and scene.one_pair_value() is None:
        return f"no values by pair of materials beyond {EXPLICIT_PAIRS_UP_TO} bodies"
    return None
