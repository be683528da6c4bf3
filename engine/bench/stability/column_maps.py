# SPDX-License-Identifier: MIT
"""Maps of loaded columns: stiffness and step of a stack, height of a tower, mass ratio."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import numpy.typing as npt

from verisim.bench.stability import limits
from verisim.bench.stability.cells import (
    HOLDS,
    METHODS,
    SPRINGS,
    Grid,
    Judge,
    Line,
    Pose,
    Prediction,
    StabilityMap,
    logs,
    make_scene,
    whole_logs,
)
from verisim.bench.stability.chain import overshoot
from verisim.bench.stability.column import Column, Path, move

EDGE = 0.2  # m
MASS = 1.0  # kg
PARTICLES = 4  # of method seed, along an edge
PARTICLE = EDGE / PARTICLES  # m, diameter
FACE = tuple(np.repeat((np.arange(PARTICLES) + 0.5) * PARTICLE - EDGE / 2, PARTICLES).tolist())
CORNERS = (-EDGE / 2, -EDGE / 2, EDGE / 2, EDGE / 2)
RESTITUTION = 0.5
LEAN = 1e-4 * EDGE  # of each body against the one below: a seed for what grows
SETTLED = 0.95  # seed starts with this share of the static overlaps, so that no fall adds to them
DEEP_DEM = 0.05  # of an edge: the engine's failure `penetration`
TILT, ASIDE, CREEP = 0.1, 0.1, 1e-3  # rad, edges, edges per s: its `toppled` and `drifted`
JITTER = 0.1  # of sqrt(g mean overlap): its `jitters`
LAST = 1e9  # s: stands for the end of the run, where creep and jitter are judged
AFTER_STEPS = 5  # a blow-up within them counts as the cause of what is seen first (outcome.py)
GROWN = math.log(1e3)  # a motion that the steps make grow by this much is a blow-up
REST_SHARE = 20.0  # dem presses a spring in by 1/20 of what is allowed
REST_DAMPING = 3.0  # steps' worth of stiffness that damp a loaded spring at rest (rest_problem.cpp)
FRAME = 1 / 60  # s


def _seed(masses: tuple[float, ...], stiffness: float) -> Column:
    return Column(
        EDGE, masses, stiffness, FACE, LEAN, PARTICLE, PARTICLES**3, 1.0, 0.5, start=SETTLED
    )


def _dem(method: str, masses: tuple[float, ...], stiffness: float, dt: float) -> Column:
    column = Column(EDGE, masses, stiffness, CORNERS, LEAN)
    if method == "dem-hybrid":
        return replace(column, damping_times=(REST_DAMPING * dt,) * column.count)
    # F = k x (1 + d x'/v0) about the static overlaps, v0 at its floor sqrt(g rest depth).
    overlaps = column.overlaps()
    relaxation = limits.hunt_crossley_damping(RESTITUTION) / math.sqrt(
        limits.GRAVITY * float(overlaps[0])
    )
    return replace(column, damping_times=tuple((relaxation * overlaps).tolist()))


def _pose(method: str, column: Column, duration: float, physics: dict[str, float | str]) -> Pose:
    bodies = [
        {
            "name": f"box{number}",
            "shape": {"box_m": [EDGE] * 3},
            "density": mass / EDGE**3,
            "position_m": [float(x), 0.0, float(z)],
        }
        for number, (mass, (x, z)) in enumerate(zip(column.masses, column.centres(), strict=True))
    ]
    scene = make_scene(
        "column",
        duration,
        {**METHODS[method], **physics},
        bodies,
        expect={"stands": [body["name"] for body in bodies]},
        restitution=RESTITUTION,
    )
    return Pose(scene, Judge("column", EDGE), duration / 500)


def _first_time(is_past: npt.NDArray[np.bool_], path: Path) -> float:
    return float(path.time[int(np.argmax(is_past))]) if is_past.any() else math.inf


def _leaves_place(path: Path) -> float:
    """When the linear motion passes a limit of `toppled` or `drifted` (s); inf if never."""
    aside, tilt = np.abs(path.shift).max(axis=1), np.abs(path.tilt).max(axis=1)
    time = _first_time(np.array((aside > ASIDE * EDGE) | (tilt > TILT)), path)
    half = len(path.time) // 2
    late = float(np.abs(path.shift[-1] - path.shift[half]).max())
    creeps = late > CREEP * EDGE * (path.time[-1] - path.time[half])
    return min(time, LAST if creeps else math.inf)


def _rings(path: Path, column: Column) -> bool:
    """Is a body still so fast in the second half that it counts as `jitters`?"""
    half = len(path.time) // 2
    with np.errstate(over="ignore"):
        speed = np.sqrt((path.speed[half:] ** 2).mean(axis=0)).max()
    return bool(speed > JITTER * math.sqrt(limits.GRAVITY * float(column.overlaps().mean())))


def _predict_seed(column: Column, duration: float, dt: float) -> Prediction:
    """Whatever the linear motion does first: sinks, blows up or leaves its place."""
    path = move(column, duration, dt, "seed")
    share = float(column.overlaps()[0]) / (PARTICLE / 2)
    sinks = _first_time(np.asarray((path.overlap > PARTICLE / 2).any(axis=1)), path)
    if share > 1:
        fall = math.sqrt(PARTICLE / limits.GRAVITY)
        sinks = min(sinks, fall)
        if dt > fall:
            # What falls a particle in a step meets new particles in each: it is thrown out again.
            return Prediction(("X", "J"), "blow-up", dt / fall)
    blows = math.inf
    if path.step_growth > 1:
        blows = dt * GROWN / math.log(path.step_growth)
    moves = _leaves_place(path)
    if blows > duration:
        blows = math.inf
    first = min(sinks, blows, moves)
    if first == math.inf:
        if _rings(path, column):
            return Prediction(("J",), "ringing", share)
        return Prediction((HOLDS,), "none", share)
    if blows <= sinks + AFTER_STEPS * dt and blows <= moves:
        return Prediction(("X", "J"), "blow-up", path.step_growth)
    if first == sinks:
        return Prediction(("S",), "crush", share)
    return Prediction(("D", "T"), "slide or buckling", share)


def _predict_dem(method: str, column: Column, duration: float, dt: float) -> Prediction:
    """Explicit steps follow the motion in time; implicit ones are backward Euler at rest."""
    is_hybrid = method == "dem-hybrid"
    path = move(column, duration, dt, "backward" if is_hybrid else "exact")
    if is_hybrid:
        depth = float(path.overlap[:, 0].max())
    else:
        depth = float(column.overlaps()[0])
        depth *= overshoot(column.masses, limits.hunt_crossley_damping(RESTITUTION))
    share = depth / (DEEP_DEM * EDGE)
    if share > 1:
        return Prediction(("S",), "crush", share)
    moves = _leaves_place(path)
    if moves < math.inf:
        return Prediction(("D", "T"), "buckling", share)
    if _rings(path, column):
        return Prediction(("J",), "ringing", share)
    return Prediction((HOLDS,), "none", share)


# (i) stiffness and step of a stack of three.

STACK = (MASS,) * 3
STACK_S = 1.0


def _stack_stiffness(method: str, relative: float) -> float:
    load = limits.GRAVITY * sum(STACK)
    if method == "seed":
        return limits.crush_stiffness(load, len(FACE), PARTICLE / relative)
    return limits.crush_stiffness(load, len(CORNERS), EDGE / relative)


def _stack_step(method: str, relative: float, step: float) -> float:
    contacts = len(FACE) if method == "seed" else len(CORNERS)
    return step / math.sqrt(contacts * _stack_stiffness(method, relative) / MASS)


def _stack_duration(dt: float) -> float:
    """A whole number of steps: the engine would shorten its steps to fit."""
    return dt * math.ceil(max(STACK_S, 100 * dt) / dt)


def _stack(method: str) -> StabilityMap:
    is_seed = method == "seed"

    def column(relative: float, step: float) -> Column:
        stiffness = _stack_stiffness(method, relative)
        if is_seed:
            return _seed(STACK, stiffness)
        return _dem(method, STACK, stiffness, _stack_step(method, relative, step))

    def pose(relative: float, step: float) -> Pose:
        stacked, dt = column(relative, step), _stack_step(method, relative, step)
        return _pose(method, stacked, _stack_duration(dt), _physics(method, stacked, dt))

    def predict(relative: float, step: float) -> Prediction:
        dt = _stack_step(method, relative, step)
        if is_seed:
            return _predict_seed(column(relative, step), _stack_duration(dt), dt)
        return _predict_dem(method, column(relative, step), _stack_duration(dt), dt)

    full = Grid(logs(0.1, 1e5, 13), logs(0.01, 4, 13)) if is_seed else None
    crush = 2.0 if is_seed else 1 / DEEP_DEM
    return StabilityMap(
        "stiffness_step",
        method,
        "Stack of three: stiffness and step",
        "stiffness against weight, " + ("n k d / W" if is_seed else "K L / W"),
        "step, " + ("dt √(n k / M)" if is_seed else "dt √(K / M)"),
        full or Grid(logs(1, 1e5, 13), logs(0.01, 4, 13)),
        Grid(logs(0.1, 1e4, 6), logs(0.1, 4, 5))
        if is_seed
        else Grid(logs(3, 1e4, 6), logs(0.1, 4, 4)),
        pose,
        predict,
        lambda: [
            Line(f"crush {crush:g}", (crush, crush), (0.01, 4)),
            *([Line("dt = 1/√(n k/M)", (0.1, 1e5), (1, 1))] if is_seed else []),
        ],
    )


def _physics(method: str, column: Column, dt: float) -> dict[str, float | str]:
    if method == "seed":
        return _seed_physics(column.stiffness, dt)
    deepest = float(column.overlaps()[0])
    return {
        "dt_s": dt,
        "stiffness_n_m": column.stiffness,
        "max_penetration_m": REST_SHARE * deepest,
    }


def _seed_physics(stiffness: float, dt: float) -> dict[str, float | str]:
    return {
        "dt_s": dt,
        "stiffness_n_m": stiffness,
        "particle_size_m": PARTICLE,
        "damping_ratio": 1.0,
        "tangential_damping_ratio": 0.5,
    }


# (ii) height of a tower and how deep its lowest contact is.

TOWER_S = 2.0
TOWER_STEP = 0.2  # dt sqrt(n k / M): well inside of the blow-up limit


def _tower(method: str) -> StabilityMap:
    is_seed = method == "seed"
    contacts = len(FACE) if is_seed else len(CORNERS)

    def column(height: float, overlap: float) -> Column:
        masses = (MASS,) * int(height)
        load = limits.GRAVITY * sum(masses)
        stiffness = limits.crush_stiffness(load, contacts, overlap * EDGE)
        return _seed(masses, stiffness) if is_seed else _dem(method, masses, stiffness, FRAME)

    def duration(dt: float) -> float:
        return dt * math.ceil(TOWER_S / dt) if is_seed else TOWER_S

    def step(tower: Column) -> float:
        if not is_seed:
            return FRAME
        return TOWER_STEP / math.sqrt(contacts * tower.stiffness / MASS)

    def pose(height: float, overlap: float) -> Pose:
        tower = column(height, overlap)
        physics = _physics(method, tower, step(tower))
        if method == "dem-explicit":
            physics["steps_per_contact"] = 20
        return _pose(method, tower, duration(step(tower)), physics)

    def predict(height: float, overlap: float) -> Prediction:
        tower = column(height, overlap)
        if is_seed:
            return _predict_seed(tower, duration(step(tower)), step(tower))
        return _predict_dem(method, tower, TOWER_S, FRAME)

    heights = whole_logs(2, 40, 12) if method != "dem-explicit" else whole_logs(2, 20, 10)
    overlaps = logs(1e-5, 1e-1, 17) if is_seed else logs(1e-4, 1e-1, 16)
    if method == "dem-explicit":
        overlaps = logs(1e-3, 1e-1, 13)
    return StabilityMap(
        "tower",
        method,
        "Tower: height and depth of its lowest contact",
        "boxes",
        "lowest contact, static overlap / edge",
        Grid(heights, overlaps),
        Grid((2, 4, 8), logs(1e-4, 1e-1, 7)) if is_seed else Grid((2, 5, 10), logs(2e-3, 1e-1, 6)),
        pose,
        predict,
        lambda: _tower_lines(is_seed, heights),
    )


@cache
def _share_of_face(is_seed: bool) -> float:
    """Second moment of the contact over the squared edge."""
    places = np.array(FACE if is_seed else CORNERS) / EDGE
    return float((places**2).mean())


def _tower_lines(is_seed: bool, heights: tuple[float, ...]) -> list[Line]:
    share = _share_of_face(is_seed)
    buckling = tuple(limits.buckling_penetration(int(n), share) for n in heights)
    whole = tuple(0.65 / n**2 for n in heights)
    deep = PARTICLE / 2 / EDGE if is_seed else DEEP_DEM
    ends = (heights[0], heights[-1])
    return [
        Line("buckling", heights, buckling),
        Line("0.65 / N²", heights, whole),
        *([Line("crush", ends, (deep, deep))] if deep <= 0.1 else []),
    ]


# (iii) a heavy box on a light one, and how fine the steps are.

RATIO_S = {"seed": 0.1, "dem-explicit": 0.5, "dem-hybrid": 0.5}
RATIO_OVERLAP = 1e-3  # of a particle diameter, static, under both boxes
RATIO_EDGE_SHARE = 1e-3  # of an edge, what dem may go in


def _ratio(method: str) -> StabilityMap:
    is_seed = method == "seed"

    def column(ratio: float) -> Column:
        masses = (MASS, ratio * MASS)
        load = limits.GRAVITY * sum(masses)
        if is_seed:
            overlap = RATIO_OVERLAP * PARTICLE
            return _seed(masses, limits.crush_stiffness(load, len(FACE), overlap))
        overlap = RATIO_EDGE_SHARE * EDGE / REST_SHARE
        return _dem(method, masses, limits.crush_stiffness(load, len(CORNERS), overlap), FRAME)

    def pose(ratio: float, substeps: float) -> Pose:
        pair = column(ratio)
        if is_seed:
            return _pose(
                method, pair, RATIO_S[method], _seed_physics(pair.stiffness, FRAME / substeps)
            )
        physics: dict[str, float | str] = {"max_penetration_m": RATIO_EDGE_SHARE * EDGE}
        if method == "dem-explicit":
            physics["steps_per_contact"] = int(substeps)
        else:
            physics["dt_s"] = FRAME / substeps
        return _pose(method, pair, RATIO_S[method], physics)

    def predict(ratio: float, substeps: float) -> Prediction:
        if is_seed:
            return _predict_seed(column(ratio), RATIO_S[method], FRAME / substeps)
        # The stiffness follows the load: depth and shape of the motion are those of ratio 1.
        return Prediction((HOLDS,), "none", RATIO_EDGE_SHARE / DEEP_DEM)

    ratios = logs(1, 1e4, 13)
    substeps = {
        "seed": tuple(2.0**n for n in range(13)),
        "dem-explicit": (20.0, 40.0, 80.0, 160.0),
        "dem-hybrid": tuple(2.0**n for n in range(7)),
    }[method]
    few = {"seed": (1.0, 8.0, 64.0, 512.0), "dem-explicit": (20.0, 40.0), "dem-hybrid": (1.0, 8.0)}
    return StabilityMap(
        "mass_ratio",
        method,
        "A heavy box on a light one",
        "mass above / mass below",
        "steps per contact" if method == "dem-explicit" else "steps per 1/60 s",
        Grid(ratios, substeps),
        Grid(logs(1, 1e4, 5), few[method]),
        pose,
        predict,
        lambda: [_ratio_line(ratios)] if is_seed else [],
    )


def _ratio_line(ratios: tuple[float, ...]) -> Line:
    """Blow-up of the light box alone, between two contacts of which each carries W."""
    overlap = RATIO_OVERLAP * PARTICLE
    steps = [
        FRAME / (1 / math.sqrt(2 * limits.GRAVITY * (1 + ratio) / overlap)) for ratio in ratios
    ]
    return Line("dt = 1/√(2 n k/M)", ratios, tuple(steps))


def column_maps() -> list[StabilityMap]:
    return [make(method) for make in (_stack, _tower, _ratio) for method in SPRINGS]
