# SPDX-License-Identifier: MIT
"""The chart's closed forms agree with fine sums of Newton's laws and with conservation laws."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from verisim import engine
from verisim.bench.chart import closed_forms
from verisim.bench.chart.catalogue import all_scenes
from verisim.bench.chart.trial import Trial, scene_document

G = 9.81


def test_tops_follow_from_the_speeds_of_a_fall_and_a_rebound() -> None:
    speed, found = math.sqrt(2 * G * 1.0), []
    for _ in range(3):
        speed *= 0.8
        found.append(speed**2 / (2 * G))
    assert closed_forms.apex_heights(1.0, 0.8, 3) == pytest.approx(found)


def test_what_falls_lands_when_energy_says_so() -> None:
    lands = math.sqrt(2 * 1.0 / G)
    height = closed_forms.fall_height(1.0, G, np.array([0, lands / 2, lands, 2 * lands]))
    assert height == pytest.approx([1, 0.75, 0, 0], abs=1e-12)


@pytest.mark.parametrize("time", [0.1, 0.3, 3.0])
def test_a_rolling_ball_goes_as_far_as_small_steps_of_coulomb_friction_take_it(time: float) -> None:
    h, x, v, surface = 1e-5, 0.0, 3.0, 0.0  # surface: spin times radius
    for _ in range(round(time / h)):
        if v > surface:
            v -= h * 0.3 * G
            surface += h * 2.5 * 0.3 * G
        x += h * v
    assert closed_forms.roll_distance(3.0, 0.3, G, time) == pytest.approx(x, rel=1e-4)  # 4e-5


def test_a_block_sticks_exactly_below_the_angle_of_friction() -> None:
    angle = math.atan(0.3)
    assert closed_forms.slide_distance(angle - 1e-6, 0.3, G, 10) == 0
    assert closed_forms.slide_distance(angle + 1e-3, 0.3, G, 10) > 0.1


@pytest.mark.parametrize("tangential", [0.5, 1.0, 2.52, 4.0])
def test_an_impact_keeps_angular_momentum_about_the_contact(tangential: float) -> None:
    normal, left, surface = closed_forms.oblique_impact(2.0, tangential, 0.8, 0.2)
    assert normal == pytest.approx(1.6)
    assert left + 0.4 * surface == pytest.approx(tangential)  # solid ball: I = 2/5 m r^2
    assert surface <= left + 1e-12  # friction stops sliding, never turns it round
    if tangential < 2.52:  # = 7/2 f (1 + e) v_n: it comes to roll
        assert surface == pytest.approx(left)
        assert left == pytest.approx(5 / 7 * tangential)


def test_free_rotation_keeps_energy_and_angular_momentum() -> None:
    edges, spin = (3.0, 2.0, 1.0), (0.01, 5.0, 0.01)
    moments = closed_forms.box_moments(edges)
    states = closed_forms.free_spin(edges, spin, 5.0)(np.linspace(0, 5, 40))
    for invariant in ((moments * states[4:].T ** 2).sum(1), ((moments * states[4:].T) ** 2).sum(1)):
        assert np.ptp(invariant) / invariant[0] < 1e-11  # measured 4e-13


@pytest.mark.parametrize("scene", [s for s in all_scenes() if s.make is None], ids=lambda s: s.key)
def test_a_run_of_dem_is_near_each_closed_form(scene, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    file = scene.write(tmp_path)
    overrides = dict(scene.settings.get("dem", {}))
    run = engine.simulate(file, overrides)
    trial = Trial(run.poses, scene_document(file), file.parent)
    for measure in scene.measures:
        # Measured at most 6e-4 (the way of the rolling ball 2.6e-4, the sticking impact 2.1e-4).
        assert measure.evaluate(trial) < 1e-3, measure.key
