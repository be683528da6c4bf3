# SPDX-License-Identifier: MIT
"""Bench scenes of stacks, dominoes, piles and heaps: what is rigid does not overlap."""

from __future__ import annotations

from functools import partial

from verisim.bench.chart import closed_system, generated, resting
from verisim.bench.chart.bench_scene import BenchScene
from verisim.bench.chart.trial import Measure

RIGID = "rigid bodies do not overlap"


def _deepest(sunk: float) -> Measure:
    return Measure(
        "deepest_m", "deepest overlap (m)", RIGID, resting.deepest_m, sunk, "sank or fell"
    )


MEAN = Measure("mean_depth_m", "mean overlap of contacts (m)", RIGID, resting.mean_depth_m)
SPEED = Measure(
    "mean_speed_m_s", "mean speed at the end (m/s)", "what lies rests", resting.mean_speed_m_s
)
GAIN = Measure(
    "energy_gain_rel",
    "energy gained (share of what falls)",
    "nothing puts energy in",
    resting.energy_gain_rel,
)
HEIGHT = Measure(
    "mean_height_m",
    "relative error of the heap's mean height",
    "the contestant's own finest run; another heap of the same bodies lies otherwise",
    resting.mean_height_m,
    is_own=True,
)


def _shift(fallen: float) -> Measure:
    return Measure(
        "shift_m", "farthest way aside (m)", "what stands stays", resting.shift_m, fallen, "fell"
    )


def _tower(count: int) -> BenchScene:
    return BenchScene(
        f"tower_{count}",
        f"A tower of {count} boxes",
        f"{count} cubes of 1 m and 1 kg stand on each other for 10 s.",
        (_deepest(0.25), _shift(0.5)),
        partial(generated.tower, count),
        quick_duration_s=4,
    )


def _ratio(ratio: int) -> BenchScene:
    return BenchScene(
        f"mass_ratio_{ratio}",
        f"{ratio} kg on 1 kg",
        f"A cube of 1 m and {ratio} kg stands on one of 1 kg for 10 s.",
        (_deepest(0.25), _shift(0.5)),
        partial(generated.mass_ratio, ratio),
        quick_duration_s=4,
    )


def _pile(columns: int, layers: int, settles_s: float = 6, measured_s: float = 2) -> BenchScene:
    count = columns**2 * layers
    return BenchScene(
        f"pile_{count}",
        f"A pile of {count} boxes at rest",
        f"{columns} x {columns} x {layers} cubes of 0.5 m and 125 kg have fallen by a centimetre "
        f"and lie; costs are those after {settles_s:g} s. Nobody sleeps.",
        (MEAN, _deepest(0.5), SPEED),
        partial(generated.stacked_pile, columns, layers, settles_s + measured_s),
        warm_up_s=settles_s,
        is_dear=count > 250,
        not_posed={
            "dem-explicit": "minutes a run",
            "seed": "minutes a run: its particles slide off each other",
        },
    )


def _tumbled_at_rest(count: int, settles_s: float = 10, measured_s: float = 2) -> BenchScene:
    return BenchScene(
        f"tumbled_{count}_rest",
        f"A tumbled pile of {count} boxes at rest",
        "Cubes of 0.5 m that fell into a pit in random orientations lie just apart, from the same "
        f"poses for all; costs are those after {settles_s:g} s. Nobody sleeps.",
        (MEAN, _deepest(0.5), SPEED),
        partial(generated.tumbled_rest, count, settles_s + measured_s),
        warm_up_s=settles_s,
        is_dear=True,
        not_posed={"dem-explicit": "minutes a run", "seed": "minutes a run"},
    )


def stack_scenes() -> list[BenchScene]:
    return [
        *(_tower(count) for count in (5, 10, 20)),
        *(_ratio(ratio) for ratio in (100, 1000, 10000)),
        BenchScene(
            "dominoes",
            "Twenty dominoes",
            "Dominoes of 20 x 100 x 200 mm, 100 mm apart; the first falls.",
            (
                Measure(
                    "last_falls_s",
                    "relative error of when the last falls",
                    "the contestant's own finest run",
                    resting.last_falls_s,
                    is_own=True,
                ),
                _deepest(0.02),
            ),
            generated.dominoes,
            is_dear=True,
        ),
        BenchScene(
            "dice_64",
            "Sixty-four dice",
            "Cubes of 0.1 m are thrown, turning, each far from the others: 64 seeds of a chaotic "
            "throw. No single way can be right; how far they go on average, and how that scatters, "
            "can. A mean of 64 ways is itself known to some 5 % only.",
            (
                Measure(
                    "mean_way_m",
                    "relative error of the mean way",
                    "the contestant's own finest run",
                    resting.mean_way_m,
                    is_own=True,
                ),
                Measure(
                    "spread_m",
                    "relative error of the spread of ways",
                    "the contestant's own finest run",
                    resting.spread_of_ways_m,
                    is_own=True,
                ),
                GAIN,
                _deepest(0.05),
            ),
            partial(generated.dice, 64),
        ),
        BenchScene(
            "collision_cloud",
            "A cloud of boxes that collide",
            "27 cubes of 0.2 m, turning, are thrown at their common centre; no gravity, no ground, "
            "restitution 0.5. Their ways are chaotic; their momentum is not.",
            (
                Measure(
                    "angular_momentum_error_rel",
                    "change of angular momentum (relative)",
                    "conserved",
                    closed_system.angular_momentum_error_rel,
                ),
                Measure(
                    "momentum_error_rel",
                    "change of momentum (relative)",
                    "conserved",
                    closed_system.momentum_error_rel,
                ),
                Measure(
                    "kinetic_gain_rel",
                    "kinetic energy gained (relative)",
                    "impacts and friction only take energy out",
                    closed_system.kinetic_gain_rel,
                ),
                Measure(
                    "kinetic_left_rel",
                    "relative error of the energy left",
                    "the contestant's own finest run; other ways lose other shares",
                    closed_system.kinetic_left_rel,
                    is_own=True,
                ),
                _deepest(0.1),
            ),
            generated.collision_cloud,
        ),
        _pile(5, 10, 1.5, 1.5),
        _pile(10, 10),
        _pile(20, 10),
        _tumbled_at_rest(250),
        _tumbled_at_rest(1000),
        BenchScene(
            "tumbled_100",
            "A tumbled pile of 100 boxes",
            "Cubes of 0.5 m in random orientations fall into a pit; costs count from the start.",
            (MEAN, _deepest(0.5), GAIN, HEIGHT),
            partial(generated.tumbled_pile, 100, 4),
            is_dear=True,
            not_posed={"dem-explicit": "minutes a run", "seed": "minutes a run"},
        ),
        BenchScene(
            "stones_100",
            "A pile of 100 meshes",
            "Convex stones of 0.3 m fall into a pit; costs count from the start.",
            (MEAN, _deepest(0.15), GAIN, HEIGHT),
            partial(generated.stones, 100, 3),
            {generated.STONE: generated.stone_mesh()},
            is_dear=True,
            not_posed={"dem-explicit": "minutes a run", "seed": "minutes a run"},
        ),
        BenchScene(
            "spheres_1000",
            "A thousand packed spheres",
            "Spheres of 10 mm settle in a square pit, restitution 0.5; costs count from the start. "
            "seed and LAMMPS take soft springs, dem may press in by 1 % of a sphere.",
            (MEAN, _deepest(0.005), SPEED, GAIN, HEIGHT),
            partial(generated.spheres, 1000, 0.4),
            settings={
                "seed": {"physics.stiffness_n_m": 1000, "physics.damping_ratio": 0.215},
                "dem": {"physics.max_penetration_m": 1e-4},
                "dem-explicit": {"physics.max_penetration_m": 1e-4},
            },
            is_dear=True,
        ),
        BenchScene(
            "sphere_cubes_64",
            "Bodies of 27 spheres",
            "64 cubes of 30 mm on a heap: 27 spheres each for seed and LAMMPS, boxes for others.",
            (GAIN, HEIGHT),
            partial(generated.sphere_cubes, 64, 1),
            settings={
                "seed": {"physics.particle_size_m": 0.01},
                "lammps": {"physics.method": "seed", "physics.particle_size_m": 0.01},
            },
        ),
    ]
