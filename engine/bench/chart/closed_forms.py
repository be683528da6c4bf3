# SPDX-License-Identifier: MIT
"""What rigid bodies do exactly, where a formula says it: one small function each, with its source.

Elementary means: from Newton's laws, Coulomb's friction and Newton's restitution, in a line that
the docstring gives. SI units.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp

Array = npt.NDArray[np.float64]


def fall_height(drop: float, gravity: float, time: Array) -> Array:
    """Height (m) of what falls from `drop` at time 0 and stays where it lands. Elementary."""
    return np.asarray(np.maximum(drop - 0.5 * gravity * time**2, 0), dtype=np.float64)


def apex_heights(drop: float, restitution: float, count: int) -> Array:
    """Tops (m) of the flights after each bounce: v' = e v, h = v^2 / 2g, so h_n = h e^(2n)."""
    powers = np.arange(2.0, 2 * count + 1, 2)
    return np.asarray(drop * restitution**powers, dtype=np.float64)


def slide_distance(angle: float, friction: float, gravity: float, time: float) -> float:
    """Way (m) down a slope of `angle` (rad) from rest: a = g (sin - friction cos); 0 if it sticks.
    Elementary."""
    pull = gravity * (math.sin(angle) - friction * math.cos(angle))
    return 0.5 * max(pull, 0.0) * time**2


def roll_distance(speed: float, friction: float, gravity: float, time: float) -> float:
    """Way (m) of a solid ball that starts sliding without spin and comes to roll.

    Friction slows it by f g and spins it up by 5/2 f g / r; they meet at t = 2 v / (7 f g), at
    5/7 of the speed (angular momentum about the line of contact). Elementary.
    """
    rolls_at = 2 * speed / (7 * friction * gravity)
    sliding = min(time, rolls_at)
    slid = speed * sliding - 0.5 * friction * gravity * sliding**2
    return slid + 5 / 7 * speed * max(time - rolls_at, 0.0)


def oblique_impact(
    normal: float, tangential: float, restitution: float, friction: float
) -> tuple[float, float, float]:
    """Normal speed, tangential speed and spin times radius of a solid ball after one impact on a
    fixed plane, without tangential rebound; speeds before are given as > 0.

    The normal impulse per mass is (1 + e) v_n; friction gives at most f of it, and no more than
    2/7 v_t, which brings the ball to roll. Source: rigid-body impact with Coulomb friction (Routh
    1860; Walton 1993 with a tangential restitution of zero).
    """
    push = min(friction * (1 + restitution) * normal, 2 / 7 * tangential)
    return restitution * normal, tangential - push, 2.5 * push


def box_moments(edges: tuple[float, ...]) -> Array:
    """Principal moments of inertia of a solid box, per mass. Elementary."""
    squares = np.square(edges)
    moments: Array = (squares.sum() - squares) / 12
    return moments


@cache
def free_spin(edges: tuple[float, ...], spin: tuple[float, ...], duration: float) -> Any:
    """Dense solution of a box's torque-free rotation: time -> quaternion (w first), spin_b.

    Euler's equations, integrated at eighth order (Dormand and Prince; Hairer, Norsett, Wanner 1993)
    to 1e-13: no closed form in elementary functions, but exact beside any run charted.
    """
    moments = box_moments(edges)

    def rates(_time: float, state: Array) -> Array:
        w, v, omega = state[0], state[1:4], state[4:]
        turning = 0.5 * np.concatenate([[-v @ omega], w * omega + np.cross(v, omega)])
        return np.concatenate([turning, -np.cross(omega, moments * omega) / moments])

    start = np.concatenate([[1, 0, 0, 0], spin])
    return solve_ivp(
        rates, (0, duration), start, "DOP853", rtol=1e-13, atol=1e-15, dense_output=True
    ).sol
