# SPDX-License-Identifier: MIT
"""The formulas of the stability maps give published numbers and agree with each other."""

from __future__ import annotations

import math

import numpy as np
import pytest

from verisim.bench.stability import column_maps, limits
from verisim.bench.stability.chain import overshoot
from verisim.bench.stability.column import Column, move, system_of
from verisim.bench.stability.head_on import bounce_restitution, pass_wall


@pytest.mark.parametrize(("boxes", "percent"), [(5, 1.93), (10, 0.56), (20, 0.15)])
def test_a_tower_on_whole_faces_buckles_at_the_published_depth(boxes: int, percent: float) -> None:
    found = 100 * limits.buckling_penetration(boxes)
    assert found == pytest.approx(percent, abs=0.005)  # measured 1.930, 0.5616, 0.1514
    # The rule of thumb 0.65 / N^2 of the same source: measured 0.47, 0.086, 0.012 apart.
    assert found == pytest.approx(65 / boxes**2, rel=0.27)


def test_the_seed_crushes_where_the_weight_presses_particles_in_whole() -> None:
    # Three boxes on a face of 16 particles of 0.05 m, under 62 N: at their limit at 78 N/m.
    stiffness = limits.crush_stiffness(62.1, 16, 0.05)
    assert stiffness == pytest.approx(78, abs=0.5)  # measured 77.6
    assert limits.relative_stiffness(16, stiffness, 0.05, 62.1) == pytest.approx(1)


@pytest.mark.parametrize("ratio", [0.0, 0.25, 1.0, 2.0])
def test_the_blow_up_step_is_where_the_steps_matrix_begins_to_grow(ratio: float) -> None:
    def radius(dt: float) -> float:  # of v += dt (-x - 2 z v); x += dt v, frequency 1
        step = np.array([[1 - dt**2, dt - 2 * ratio * dt**2], [-dt, 1 - 2 * ratio * dt]])
        return float(np.abs(np.linalg.eigvals(step)).max())

    limit = limits.blow_up_step(1, ratio)
    assert radius(0.999 * limit) <= 1 + 1e-12  # 1 if undamped
    assert radius(1.001 * limit) > 1.0005  # least measured 1.0014


def test_published_damping_of_hunt_and_crossley() -> None:
    # Known digits of ln((1 + d)/(1 - e d)) = d (1 + e).
    for restitution, d in ((0.9, 0.1665), (0.5, 1.4328), (0.2, 4.919)):
        assert limits.hunt_crossley_damping(restitution) == pytest.approx(d, rel=2e-4)


def test_a_spring_and_dashpot_without_clamp_return_the_restitution_meant() -> None:
    for restitution in (0.2, 0.5, 0.8):
        damping = limits.damping_for_restitution(restitution)
        found = bounce_restitution(damping, 20_000, 0.5)
        assert found == pytest.approx(restitution, abs=1e-4)  # measured at most 4e-5


def test_impact_depth_is_that_of_a_damped_half_swing() -> None:
    dt, x, v, deepest = 1e-4, 0.0, 1.0, 0.0
    for _ in range(40_000):
        v -= dt * (x + 2 * 0.3 * v)
        x += dt * v
        deepest = max(deepest, x)
    assert limits.impact_depth(1, 1, 1, 0.3) == pytest.approx(deepest, rel=1e-4)  # measured 5e-5


def test_a_ball_steps_over_a_wall_only_if_its_way_is_longer_than_the_wall() -> None:
    stiff = [pass_wall(1, 1, 1e4, 0.5, way, 0.5) for way in (1e-4, 1e-3, 4.0)]
    assert [end.ends_beyond for end in stiff] == [False, False, True]
    assert stiff[0].speed == pytest.approx(-1, abs=0.01)
    # Past the barrier of energy, k D^2 < m v^2, no step is short enough.
    assert pass_wall(1, 1, 0.9 / 0.5**2, 0.5, 1e-4, 0.5).ends_beyond


def test_a_column_of_hinges_buckles_where_its_linear_motion_begins_to_grow() -> None:
    # Corners as contacts, slip almost forbidden: the lowest eigenvalue changes sign at the limit.
    edge, corners = 0.2, (-0.1, -0.1, 0.1, 0.1)
    limit = limits.buckling_penetration(5, 0.25)
    for share, grows in ((0.98, False), (1.02, True)):
        load = 5 * limits.GRAVITY
        stiffness = limits.crush_stiffness(load, 4, share * limit * edge)
        column = Column(edge, (1.0,) * 5, stiffness, corners, 0, tangential_stiffness_ratio=1e5)
        least = np.linalg.eigvalsh(system_of(column).stiffness)[0]
        assert bool(least < 0) is grows


def test_a_pair_of_lattices_slides_off_at_the_rate_of_its_formula() -> None:
    # Heavy drag makes inertia small.
    edge, diameter, stiffness = 0.2, 0.05, 1e5
    column = Column(
        edge, (1.0, 1.0), stiffness, (-0.05, 0.05), 1e-6, diameter, 64, 1.0, 50.0, start=1.0
    )
    overlap = float(column.overlaps()[1])
    drag = 50 * 2 * math.sqrt(stiffness / 64 / 2)
    path = move(column, 40, 0.0, "exact")
    apart = path.shift[:, 1] - path.shift[:, 0] + column.lean
    late = slice(len(apart) // 2, None)
    slope = np.polyfit(path.time[late], np.log(np.abs(apart[late])), 1)[0]
    expected = limits.slide_rate(overlap, diameter, stiffness, drag)
    assert slope == pytest.approx(expected, rel=5e-3)  # measured 1.2e-3: inertia


def test_a_column_let_go_overshoots_by_less_than_its_weight_again() -> None:
    damping = limits.hunt_crossley_damping(0.5)
    # Undamped, one body on a spring goes twice as deep as it rests.
    assert overshoot((1.0,), 0.0) == pytest.approx(2, abs=1e-3)  # measured 2.0003
    found = [overshoot((1.0,) * count, damping) for count in (2, 5)]
    assert found == pytest.approx([1.212, 1.312], abs=1e-3)  # what the engine does, too


def test_predictions_of_the_stack_follow_crush_and_blow_up() -> None:
    stack = next(each for each in column_maps.column_maps() if each.name == "stiffness_step__seed")
    assert stack.predict(1.5, 0.1).codes == ("S",)
    assert stack.predict(1e4, 0.2).codes == ("ok",)
    assert stack.predict(1e4, 1.0).codes == ("X", "J")
    assert stack.predict(10, 0.1).codes == ("D", "T")
