# SPDX-License-Identifier: MIT
"""Maps of impacts: a fast ball at a thin wall, a cube on its face, edge and corner, restitution."""

from __future__ import annotations

import math

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
    Scene,
    StabilityMap,
    logs,
    make_scene,
    whole_logs,
)
from verisim.bench.stability.head_on import bounce_restitution, pass_wall

GAIN = 1.05  # of the energy: the engine's failure `energy_gain`
DEEP_DEM = 0.05  # of a body: its failure `penetration`
WRONG = 0.02  # of a restitution
PHASE = 0.5  # steps, or contact times, before touching, so that no cell hits a tie
WEIGHTLESS = [0, 0, 0]

# (iv) a ball at a wall that is as thick as the ball.

BALL = 0.1  # m, diameter
BALL_SPEED = 10.0  # m/s
BALL_DENSITY = 1000.0
BALL_MASS = BALL_DENSITY * math.pi / 6 * BALL**3


def _whole(duration: float, dt: float) -> float:
    """A whole number of steps: the engine would shorten its steps to fit."""
    return dt * math.ceil(duration / dt)


def _wall_stiffness(barrier: float) -> float:
    """N/m: at barrier 1 the ball's energy just presses it to the middle of the wall."""
    return BALL_MASS * (BALL_SPEED / (barrier * BALL)) ** 2


def _wall(method: str) -> StabilityMap:
    is_seed = method == "seed"

    def pose(way: float, barrier: float) -> Pose:
        dt = way * BALL / BALL_SPEED
        physics: Scene = {**METHODS[method], "dt_s": dt, "stiffness_n_m": _wall_stiffness(barrier)}
        if is_seed:
            physics |= {
                "particle_size_m": BALL,
                "damping_ratio": 0,
                "tangential_damping_ratio": 0,
            }
        flight = PHASE * dt
        contact = math.pi * barrier * BALL / BALL_SPEED
        duration = _whole(flight + 3 * contact + 4 * BALL / BALL_SPEED + 4 * dt, dt)
        wall = {
            "name": "wall",
            "shape": {"box_m": [3 * BALL, 3 * BALL, BALL]},
            "density": BALL_DENSITY,
            "position_m": [0, 0, 0],
            "motion": "fixed",
        }
        ball = {
            "name": "ball",
            "shape": {"sphere_radius_m": BALL / 2},
            "density": BALL_DENSITY,
            "position_m": [0, 0, BALL + flight * BALL_SPEED],
            "velocity_m_s": [0, 0, -BALL_SPEED],
        }
        scene = make_scene(
            "wall",
            duration,
            physics,
            [wall, ball],
            gravity_m_s2=WEIGHTLESS,
            ground=False,
            restitution=1.0,
            friction=0.0,
        )
        return Pose(scene, Judge("wall", BALL), duration / 200)

    def predict(way: float, barrier: float) -> Prediction:
        if not is_seed:
            return _predict_wall_dem(barrier)
        dt = way * BALL / BALL_SPEED
        stiffness = _wall_stiffness(barrier)
        end = pass_wall(BALL_MASS, BALL_SPEED, stiffness, BALL, dt, PHASE)
        if end.ends_beyond:
            limit = "barrier" if barrier > 1 else "thickness" if way > 2 else "blow-up"
            return Prediction(("P",), limit, barrier if barrier > 1 else way / 2)
        if (end.speed / BALL_SPEED) ** 2 > GAIN:
            return Prediction(("X",), "blow-up", way / barrier / 2)
        if end.deepest > BALL / 2:
            return Prediction(("S",), "depth", end.deepest / (BALL / 2))
        return Prediction((HOLDS,), "none", barrier)

    lines = [
        Line("barrier ½mv² = ½kD²", (0.05, 4), (1, 1)),
        *(
            [
                Line("way = thickness 2D", (2, 2), (0.05, 4)),
                Line("blow-up ω dt = 2", (0.1, 4), (0.05, 2)),
                Line("half a particle deep", (0.05, 4), (0.5, 0.5)),
            ]
            if is_seed
            else [Line("5 % deep", (0.05, 4), (DEEP_DEM, DEEP_DEM))]
        ),
    ]
    ways = logs(0.05, 4, 16)
    barriers = logs(0.05, 4, 16) if is_seed else logs(0.005, 4, 16)
    few = logs(0.05, 4, 7) if is_seed else logs(0.01, 4, 6)
    return StabilityMap(
        "tunnelling",
        method,
        "A fast ball at a wall as thick as itself",
        "way in a step against thickness, v dt / D",
        "speed against barrier, v √(m/k) / D",
        Grid(ways, barriers),
        Grid(logs(0.1, 4, 7 if is_seed else 4), few),
        pose,
        predict,
        lambda: lines,
    )


def _predict_wall_dem(barrier: float) -> Prediction:
    """Steps end on touch-down and resolve the contact, so only the spring's energy counts: the
    compression is v sqrt(m/k), restitution 1."""
    if barrier > 1:
        return Prediction(("P",), "barrier", barrier)
    if barrier > DEEP_DEM:
        return Prediction(("S",), "depth", barrier / DEEP_DEM)
    return Prediction((HOLDS,), "none", barrier / DEEP_DEM)


# (v) particle size and pose of a cube that lands.

CUBE = 0.2  # m, edge
CUBE_MASS = 2.0  # kg
CUBE_SPEED = 1.0  # m/s
POSES = ("flat", "edge", "corner")
COMPRESSIONS = (0.001, 0.003, 0.01, 0.03)  # of the edge, v sqrt(M / K) with all of a face
ROWS = [(name, share) for name in POSES for share in COMPRESSIONS]
FINE_STEP = 0.05  # dt times the fastest frequency


def _turn(name: str) -> list[float]:
    """Quaternion w, x, y, z that brings an edge or a corner to the bottom."""
    if name == "flat":
        return [1, 0, 0, 0]
    if name == "edge":
        return [math.cos(math.pi / 8), math.sin(math.pi / 8), 0, 0]
    # The diagonal (1, 1, 1) to z: about (1, -1, 0) by acos(1/sqrt(3)).
    half = math.acos(1 / math.sqrt(3)) / 2
    side = math.sin(half) / math.sqrt(2)
    return [math.cos(half), side, -side, 0]


def _reach(name: str, count: int) -> float:
    """Height of the centre when the lowest particles touch the ground (m)."""
    diameter = CUBE / count
    inner = (CUBE - diameter) / 2
    dimensions = {"flat": 1, "edge": 2, "corner": 3}[name]
    return inner * math.sqrt(dimensions) + diameter / 2


def _first_contacts(name: str, count: int) -> int:
    return {"flat": count**2, "edge": count, "corner": 1}[name]


def _landing() -> StabilityMap:
    def contact_stiffness(share: float, count: int) -> float:
        return CUBE_MASS * (CUBE_SPEED / (share * CUBE)) ** 2 / count**2

    def pose(size: float, row: float) -> Pose:
        (name, share), count = ROWS[int(row)], int(size)
        stiffness = contact_stiffness(share, count)
        lowest = _first_contacts(name, count)
        slow = math.sqrt(lowest * stiffness / CUBE_MASS)
        fast = math.sqrt(count**2 * stiffness / CUBE_MASS)
        dt = FINE_STEP / fast
        flight = PHASE * dt
        duration = _whole(flight + 1.2 * math.pi / slow, dt)
        cube = {
            "name": "cube",
            "shape": {"box_m": [CUBE] * 3},
            "density": CUBE_MASS / CUBE**3,
            "position_m": [0, 0, _reach(name, count) + flight * CUBE_SPEED],
            "orientation_wxyz": _turn(name),
            "velocity_m_s": [0, 0, -CUBE_SPEED],
        }
        physics = {
            **METHODS["seed"],
            "dt_s": dt,
            "stiffness_n_m": stiffness,
            "particle_size_m": CUBE / count,
            "damping_ratio": 1.0,
            "tangential_damping_ratio": 0.5,
        }
        scene = make_scene("landing", duration, physics, [cube], gravity_m_s2=WEIGHTLESS)
        return Pose(scene, Judge("landing", CUBE), duration / 100)

    def predict(size: float, row: float) -> Prediction:
        (name, share), count = ROWS[int(row)], int(size)
        lowest = _first_contacts(name, count)
        # Of n parallel contacts, each critical for its own particle: ratio sqrt(n / particles).
        damping = math.sqrt(lowest / count**3)
        stiffness = lowest * contact_stiffness(share, count)
        depth = limits.impact_depth(CUBE_SPEED, CUBE_MASS, stiffness, damping)
        ratio = depth / (0.5 * CUBE / count)
        return Prediction(("S",) if ratio > 1 else (HOLDS,), "depth", ratio)

    return StabilityMap(
        "particle_size",
        "seed",
        "A cube that lands on its face, edge or corner",
        "particles along an edge, L / d",
        "pose and softness, v √(M/K) / L",
        Grid(whole_logs(2, 32, 16), tuple(float(row) for row in range(len(ROWS)))),
        Grid((2, 4, 8), tuple(float(row) for row in range(len(ROWS)))),
        pose,
        predict,
        list,
        lambda row: f"{ROWS[int(row)][0]} {100 * ROWS[int(row)][1]:g} %",
    )


# (vi) restitution and steps per contact of a ball on the ground.

BOUNCE_FREQUENCY = 1000.0  # rad/s of ball and spring
LEAST_DEM = 0.02  # dem counts less as that (engine/dem/restitution.h)
BOUNCE_SPEED = 1.0  # m/s: 1 mm of compression, small beside the ball


def _bounce(method: str) -> StabilityMap:
    is_seed = method == "seed"
    mass = BALL_MASS

    def pose(steps: float, restitution: float) -> Pose:
        dt = math.pi / (BOUNCE_FREQUENCY * steps)
        flight = PHASE * dt if is_seed else 1e-3
        physics: Scene = {**METHODS[method]}
        if is_seed:
            physics |= {
                "dt_s": dt,
                "stiffness_n_m": mass * BOUNCE_FREQUENCY**2,
                "damping_ratio": limits.damping_for_restitution(restitution),
                "tangential_damping_ratio": 0,
            }
        else:
            physics |= {"steps_per_contact": int(steps), "max_penetration_m": 2e-3}
        ball = {
            "name": "ball",
            "shape": {"sphere_radius_m": BALL / 2},
            "density": BALL_DENSITY,
            "position_m": [0, 0, BALL / 2 + flight * BOUNCE_SPEED],
            "velocity_m_s": [0, 0, -BOUNCE_SPEED],
        }
        duration = _whole(flight + 10 * math.pi / BOUNCE_FREQUENCY + 10 * dt, dt)
        scene = make_scene(
            "bounce",
            duration,
            physics,
            [ball],
            gravity_m_s2=WEIGHTLESS,
            restitution=restitution,
            friction=0.0,
        )
        return Pose(scene, Judge("bounce", BALL, restitution), duration / 50)

    def predict(steps: float, restitution: float) -> Prediction:
        if not is_seed:
            return Prediction((HOLDS,), "none", 0)
        damping = limits.damping_for_restitution(restitution)
        found = bounce_restitution(damping, steps, PHASE)
        if found**2 > GAIN:
            return Prediction(("X",), "blow-up", found)
        error = abs(found - restitution) / WRONG
        return Prediction(("E",) if error > 1 else (HOLDS,), "step error", error)

    restitutions = tuple(round(0.05 * n, 2) for n in range(1, 21))
    if not is_seed:
        restitutions = (LEAST_DEM, *restitutions)
    steps = whole_logs(2, 128, 16) if is_seed else whole_logs(20, 1000, 12)
    few = (2.0, 4.0, 8.0, 16.0, 32.0, 64.0) if is_seed else (20.0, 100.0, 500.0)
    return StabilityMap(
        "restitution",
        method,
        "A ball that bounces: restitution and steps per contact",
        "steps per contact",
        "restitution, meant by the dashpot" if is_seed else "restitution, of the materials",
        Grid(steps, restitutions),
        Grid(few, (0.1, 0.3, 0.5, 0.7, 0.9)),
        pose,
        predict,
        lambda: _bounce_lines(restitutions) if is_seed else [],
    )


def _bounce_lines(restitutions: tuple[float, ...]) -> list[Line]:
    steps = [
        math.pi / limits.blow_up_step(1, limits.damping_for_restitution(e)) for e in restitutions
    ]
    return [Line("stable while in contact", tuple(steps), restitutions)]


def impact_maps() -> list[StabilityMap]:
    maps = [_wall(method) for method in SPRINGS]
    return [*maps, _landing(), *(_bounce(method) for method in SPRINGS)]
