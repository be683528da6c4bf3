# SPDX-License-Identifier: MIT
"""The closed-form limits beyond which a method fails: one small function each, with its source."""

from __future__ import annotations

import math

import numpy as np

GRAVITY = 9.81  # m/s2


def crush_stiffness(load: float, contacts: int, overlap: float) -> float:
    """Stiffness (N/m) of one of `contacts` equal springs that just holds `load` (N) at `overlap`.

    Source: static balance, W = n k overlap. Method seed counts an overlap of d/2 as failed.
    """
    return load / (contacts * overlap)


def relative_stiffness(contacts: int, stiffness: float, diameter: float, load: float) -> float:
    """k^ = n k d / W: springs' force at a whole diameter over the weight that they carry."""
    return contacts * stiffness * diameter / load


def blow_up_step(frequency: float, damping_ratio: float) -> float:
    """Longest stable step (s) of semi-implicit Euler on x'' = -w^2 x - 2 z w x'.

    Forces are those of the step's start. The step's matrix has determinant 1 - 2 z w h and trace
    2 - 2 z w h - w^2 h^2; both roots are inside of the unit circle while trace > -1 - determinant:
    w h < 2 (sqrt(1 + z^2) - z). Derived here; z = 0 gives the textbook w h < 2 (Hairer, Lubich,
    Wanner 2006, Geometric Numerical Integration, I.1).
    """
    return 2 * (math.hypot(1, damping_ratio) - damping_ratio) / frequency


def buckling_penetration(num_boxes: int, inertia_share: float = 1 / 12) -> float:
    """Static overlap of the lowest contact, as a share of the edge, at which a tower topples.

    A chain of hinges between equal cubes: tilts t_j, hinge stiffness K L^2 s with s the second
    moment of the contact over its width squared (1/12 a whole face, 1/4 its two edges' corners);
    energy sum K L^2 s (t_j - t_(j-1))^2 / 2 - m g L sum (N - j + 1/2) t_j^2 / 2 loses its minimum
    at the largest eigenvalue of the pencil. About 0.65 / N^2 for a whole face. Source: derived here
    (discrete form of Greenhill 1881, Proc. Camb. Phil. Soc. 4, a column under its own weight).
    """
    links = np.eye(num_boxes) - np.eye(num_boxes, k=-1)
    root = np.diag(np.sqrt(num_boxes - np.arange(1, num_boxes + 1) + 0.5))
    # The largest root of det(weights - hinge links^T links) = 0, hinge in units of m g L.
    hinge = float(np.linalg.eigvalsh(root @ np.linalg.inv(links.T @ links) @ root)[-1])
    return num_boxes * inertia_share / hinge


def slide_rate(overlap: float, diameter: float, stiffness: float, drag: float) -> float:
    """Growth rate (1/s) at which a loaded pair of balls, head on, slides off its summit.

    The load F = k overlap pushes a summit that is t aside by F t / r, r = d - overlap; a viscous
    contact (coefficient `drag`) resists with drag t': t grows as exp(F / (r drag) time). Derived
    here; it is the creep of a lattice on a lattice, which no viscous force can stop.
    """
    return stiffness * overlap / ((diameter - overlap) * drag)


def impact_depth(speed: float, mass: float, stiffness: float, damping_ratio: float = 0) -> float:
    """Deepest compression (m) of a spring and dashpot that stop `mass` at `speed`.

    Source: damped half swing, v/w exp(-z/q atan(q/z)), q = sqrt(1 - z^2); energy alone for z = 0.
    """
    frequency = math.sqrt(stiffness / mass)
    if damping_ratio == 0:
        return speed / frequency
    if damping_ratio >= 1:
        return speed / frequency * math.exp(-1)  # critical; deeper damping is not used here
    q = math.sqrt(1 - damping_ratio**2)
    return speed / frequency * math.exp(-damping_ratio / q * math.atan2(q, damping_ratio))


def damping_for_restitution(restitution: float) -> float:
    """Damping ratio of a linear spring and dashpot that may pull: -ln e / sqrt(pi^2 + ln^2 e)."""
    log = math.log(restitution)
    return -log / math.hypot(math.pi, log)


def hunt_crossley_damping(restitution: float) -> float:
    """d of F = k x (1 + d x'/v0): ln((1 + d)/(1 - e d)) = d (1 + e) (Hunt, Crossley 1975)."""
    if restitution >= 1:
        return 0.0

    def energy_left(d: float) -> float:
        return math.log((1 + d) / (1 - d * restitution)) - d * (1 + restitution)

    low, high = 1e-6, (1 - 1e-12) / restitution  # energy is lost at the first, won at the last
    while high - low > 1e-12 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if energy_left(middle) < 0 else (low, middle)
    return low
