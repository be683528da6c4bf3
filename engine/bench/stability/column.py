# SPDX-License-Identifier: MIT
"""Small motions of a leaning column of equal cubes on springs, as the steps of a method make them.

The column is plane: body j has x, z and a tilt (rad, positive turns +x towards +z); the lowest one
stands on a plane. Energies are taken to second order about the loaded column. Derived here; no
number is fitted.

  lattice  pairs of particles (Harada 2007), centres r = d - overlap apart, load F, stiffness k:
           k/2 along^2 - F/(2 r) across^2; tilting lowers a centre that is p off the middle of its
           body by tilt^2 p / 2, which gives - F p tilt^2 / 2
  corners  springs at the corners x_i of a common face: k/2 (lift + x_i turn)^2, turn = tilt above
           - tilt below; k_t/2 slip^2; and the load W on a face that turns with the body below it,
           W (tilt_below shift + L tilt_below^2 / 2 - L turn^2 / 4)

Without slip the latter is the chain of hinges of `limits.buckling_penetration`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from verisim.bench.stability.limits import GRAVITY

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]

SWINGS_FAST = 0.5  # rad per step: faster motions are made by the steps, slower ones by the column
LARGEST_LOG = 80.0  # growth beyond e^80 is cut: far past any limit, and powers stay finite


@dataclass(frozen=True)
class Column:
    """Cubes from the bottom up. Lengths in m."""

    edge: float
    masses: tuple[float, ...]  # kg
    stiffness: float  # N/m, of one contact
    contact_x: tuple[float, ...]  # where the contacts of a face are, from its middle
    lean: float  # sideways offset of each body against the one below
    particle: float = 0.0  # diameter of lattice particles; 0: corners of faces
    particles_per_body: int = 1
    damping_ratio: float = 0.0  # of one particle contact (lattice)
    tangential_damping_ratio: float = 0.0
    damping_times: tuple[float, ...] = ()  # s, dashpot over spring below each body (corners)
    tangential_stiffness_ratio: float = 0.8  # over the normal stiffness (corners)
    start: float = 0.0  # overlaps at the start, as a share of the static ones

    @property
    def count(self) -> int:
        return len(self.masses)

    def loads(self) -> Array:
        """Weight on the contact below each body (N)."""
        loads: Array = GRAVITY * np.cumsum(np.array(self.masses)[::-1])[::-1]
        return loads

    def overlaps(self) -> Array:
        """Static overlap below each body (m)."""
        return self.loads() / (len(self.contact_x) * self.stiffness)

    def start_overlaps(self) -> Array:
        """At the start; never so deep that the start itself has failed."""
        deepest = 0.4 * self.particle if self.particle else 0.04 * self.edge
        overlaps: Array = np.minimum(self.start * self.overlaps(), deepest)
        return overlaps

    def centres(self) -> Array:
        """Places [body, (x, z)] at the start."""
        height = np.cumsum(self.edge - self.start_overlaps()) - self.edge / 2
        return np.column_stack((self.lean * np.arange(self.count), height))


@dataclass
class System:
    """mass q'' + damping q' + stiffness q = push; q = (x, z, tilt) of each body from the start."""

    mass: Array
    stiffness: Array
    damping: Array
    push: Array

    def motion_of(self, body: int, place: tuple[float, float], sign: int) -> tuple[Array, Array]:
        """Rows that take q to how a point of a body moves along x and z; zeros for the plane."""
        along_x, along_z = np.zeros(self.push.size), np.zeros(self.push.size)
        if body >= 0:
            along_x[3 * body], along_x[3 * body + 2] = sign, -sign * place[1]
            along_z[3 * body + 1], along_z[3 * body + 2] = sign, sign * place[0]
        return along_x, along_z

    def relative(self, above: int, x: float, reach: float) -> tuple[Array, Array]:
        """How the body above moves against the one below, `reach` from both middles."""
        upper = self.motion_of(above, (x, -reach), 1)
        lower = self.motion_of(above - 1, (x, reach), -1)
        return upper[0] + lower[0], upper[1] + lower[1]


def system_of(column: Column) -> System:
    size = 3 * column.count
    mass = np.array([[m, m, m * column.edge**2 / 6] for m in column.masses]).ravel()
    zero = np.zeros((size, size))
    system = System(mass, zero.copy(), zero.copy(), np.zeros(size))
    add = _add_lattice if column.particle else _add_corners
    for above in range(column.count):
        add(system, column, above)
        _push_up(system, column, above)
    return system


def _push_up(system: System, column: Column, above: int) -> None:
    """What the overlap at the start lacks of the static one falls."""
    lacking = column.overlaps()[above] - column.start_overlaps()[above]
    force = lacking * column.stiffness * len(column.contact_x)
    system.push[3 * above + 1] -= force
    if above > 0:
        system.push[3 * above - 2] += force


def _add_lattice(system: System, column: Column, above: int) -> None:
    num_contacts = len(column.contact_x)
    load, overlap = column.loads()[above] / num_contacts, column.overlaps()[above]
    reach = (column.edge - column.particle) / 2  # to the outer layer of particles
    apart = max(column.particle - overlap, 0.1 * column.particle)
    touch = column.edge / 2 - min(overlap, column.particle) / 2  # dashpots act amid the overlap
    particle_mass = column.masses[above] / column.particles_per_body
    if above > 0:
        other = column.masses[above - 1] / column.particles_per_body
        particle_mass = particle_mass * other / (particle_mass + other)
    critical = 2 * np.sqrt(column.stiffness * particle_mass)
    for x in column.contact_x:
        across, along = system.relative(above, x, reach)
        system.stiffness += column.stiffness * np.outer(along, along)
        if above > 0:
            system.stiffness -= load / apart * np.outer(across, across)
            system.push += load / apart * column.lean * across
        across, along = system.relative(above, x, touch)
        system.damping += column.damping_ratio * critical * np.outer(along, along)
        system.damping += column.tangential_damping_ratio * critical * np.outer(across, across)
        for body in (above, above - 1):
            if body >= 0:
                system.stiffness[3 * body + 2, 3 * body + 2] -= load * reach


def _add_corners(system: System, column: Column, above: int) -> None:
    load, edge = column.loads()[above], column.edge
    slip, _ = system.relative(above, 0, edge / 2)
    shift, lift = system.relative(above, 0, 0)
    turn = np.zeros_like(lift)
    turn[3 * above + 2] = 1
    if above > 0:
        turn[3 * above - 1] = -1
    damping = column.stiffness * (column.damping_times[above] if column.damping_times else 0)
    shear = column.tangential_stiffness_ratio
    for x in column.contact_x:
        opening = np.outer(lift + x * turn, lift + x * turn)
        system.stiffness += column.stiffness * (opening + shear * np.outer(slip, slip))
        system.damping += damping * (opening + shear * np.outer(slip, slip))
    system.stiffness -= load * edge / 2 * np.outer(turn, turn)
    if above > 0:
        face = np.zeros_like(lift)
        face[3 * above - 1] = 1
        system.stiffness += load * (np.outer(face, shift) + np.outer(shift, face))
        system.stiffness += load * edge * np.outer(face, face)
        for body in (above, above - 1):  # the load is amid the common face, half a lean away
            system.push[3 * body + 2] -= load * column.lean / 2


@dataclass(frozen=True)
class Path:
    """Motion of the bodies at some times, and what the steps add to it."""

    time: Array  # s
    shift: Array  # [time, body], m sideways from the start
    tilt: Array  # [time, body], rad
    overlap: Array  # [time, body], m, of the contact below
    speed: Array  # [time, body], m/s, of the centres
    step_growth: float  # largest factor per step of a motion that swings within a few steps


def move(
    column: Column, duration: float, dt: float, steps: str = "exact", num_times: int = 240
) -> Path:
    """The column over `duration` (s). Cost: cubic in the number of bodies.

    steps: `seed` (semi-implicit Euler with the forces of the step's start), `backward` (backward
    Euler) or `exact` (in time, no steps).
    """
    system = system_of(column)
    size = system.push.size
    kicks = system.stiffness / system.mass[:, None]
    drags = system.damping / system.mass[:, None]
    one, zero = np.eye(size), np.zeros((size, size))
    if steps == "seed":
        matrix = np.block(
            [[one - dt**2 * kicks, dt * one - dt**2 * drags], [-dt * kicks, one - dt * drags]]
        )
    else:
        matrix = np.block([[zero, one], [-kicks, -drags]])
    values, vectors = np.linalg.eig(matrix)
    rates = _rates(values.astype(complex), dt, steps)
    fast = np.abs(rates.imag) * dt > SWINGS_FAST
    growth = float(np.exp(rates[fast].real * dt).max(initial=0)) if steps == "seed" else 0.0
    time = np.linspace(0, duration, num_times)
    if steps != "exact":
        time = dt * np.unique(np.round(time / dt))
    rest = np.linalg.lstsq(system.stiffness, system.push, rcond=None)[0]
    start = np.linalg.solve(vectors, np.concatenate((-rest, np.zeros(size))))
    logs = np.outer(time, rates)
    powers = np.exp(np.minimum(logs.real, LARGEST_LOG) + 1j * logs.imag)
    state = ((powers * start) @ vectors.T).real.reshape(len(time), 2, column.count, 3)
    motion = rest.reshape(column.count, 3) + state[:, 0]
    speed = np.linalg.norm(state[:, 1, :, :2], axis=-1)
    lower = np.concatenate((np.zeros((len(time), 1)), motion[:, :-1, 1]), axis=1)
    overlap = column.start_overlaps() + lower - motion[:, :, 1]
    return Path(time, motion[:, :, 0], motion[:, :, 2], overlap, speed, growth)


def _rates(values: Complex, dt: float, steps: str) -> Complex:
    """Complex growth rates (1/s) of the modes from the eigenvalues of step or system."""
    if steps == "seed":
        return np.asarray(np.log(values + 1e-300) / dt, complex)
    if steps == "backward":
        return np.asarray(-np.log(1 - dt * values) / dt, complex)
    return values
