# SPDX-License-Identifier: MIT
"""Targets, growth of cost and dem against seed, from made-up points and tables."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path
from typing import Any

import pytest

from verisim.bench.chart.against_seed import comparisons
from verisim.bench.chart.catalogue import all_scenes, choose_scenes
from verisim.bench.chart.front import Point
from verisim.bench.chart.growth import growths
from verisim.bench.chart.tables import columns_of
from verisim.bench.chart.targets import FEW_BODIES, Target, targets
from verisim.bench.chart.written_points import Points, written_points


def points(method: str, *pairs: tuple[float, float], failed: str = "") -> list[Point]:
    """One point for each error and cost."""
    return [
        Point(method, f"setting {n}", error, (cost,) * 3, failed)
        for n, (error, cost) in enumerate(pairs)
    ]


def judged(scene: str, found: Points) -> list[Target]:
    return [target for target in targets(found, []) if target.scene == scene]


def bounce(*some: list[Point]) -> Target:
    """Verdict beside other engines."""
    return judged("bounce", {("bounce", "apex_error_rel"): [each for one in some for each in one]})[
        0
    ]


def test_nothing_is_judged_without_other_engines_or_without_runs() -> None:
    assert {target.verdict for target in targets({}, [])} == {"not measured"}
    assert bounce(points("dem", (1e-5, 1))).verdict == "not measured"
    assert bounce(points("rapier-stiff", (1e-5, 1))).verdict == "not measured"


def test_few_bodies_are_judged_where_the_other_front_comes_nearest() -> None:
    own = points("dem", (5e-3, 1), (1e-4, 3))
    assert bounce(own, points("ode-20", (5e-3, 2), (1e-3, 4))).verdict == "met"
    # As cheap at 1e-2, 1e-3 and 1e-4; yet its point at 4e-3 is left of ours.
    found = bounce(own, points("ode-20", (4e-3, 1.5), (1e-3, 4)))
    assert found.verdict == "not met"
    assert "at 0.004 dem costs 2 of ode-20, setting 0" in found.measured


def test_a_level_that_we_do_not_reach_is_not_met_and_one_that_nobody_reaches_is() -> None:
    other = points("ode-20", (1e-3, 4))
    assert bounce(points("dem", (5e-3, 1)), other).verdict == "not met"
    assert bounce(points("dem", (5e-4, 1)), other).verdict == "met"
    alone = bounce(points("dem", (5e-3, 1)), points("ode-20", (0.5, 1)))
    assert alone.verdict == "met" and "no other engine reaches 0.01" in alone.measured


def test_costs_within_the_noise_are_a_tie() -> None:
    own = [Point("dem", "a", 1e-5, (1.0, 1.1, 1.2))]
    assert bounce(own, [Point("ode-20", "b", 1e-5, (0.9, 1.05, 1.1))]).verdict == "tie"


def test_an_engine_that_is_exact_is_to_be_met_at_an_error_of_a_thousandth() -> None:
    key = ("cradle", "speed_error_rel")
    exact = points("ode-dWorldStep", (1e-9, 2.0), (0.5, 0.1))
    found = judged("cradle", {key: points("dem", (9e-4, 1.5), (1e-7, 8)) + exact})[0]
    assert found.verdict == "met" and "0.75 of the cost" in found.measured
    assert judged("cradle", {key: points("dem", (1e-7, 8)) + exact})[0].verdict == "not met"


def pile(scene: str, **settings: tuple[float, float, float]) -> Points:
    """Contestants by name (- for _) with cost, mean and deepest overlap."""
    of = {name.replace("_", "-"): values for name, values in settings.items()}
    return {
        (scene, "mean_depth_m"): [Point(m, "s", v[1], (v[0],) * 3) for m, v in of.items()],
        (scene, "deepest_m"): [Point(m, "s", v[2], (v[0],) * 3) for m, v in of.items()],
    }


@pytest.mark.parametrize(
    ("dem", "verdict"),
    [
        ((0.06, 1e-4, 3e-4), "met"),
        ((0.09, 1e-4, 3e-4), "not met"),  # more than two thirds of the cost
        ((0.06, 2e-4, 3e-4), "not met"),
        ((0.06, 1e-4, 5e-4), "not met"),
    ],
)
def test_a_pile_is_to_be_cheaper_and_less_deep_at_one_setting(
    dem: tuple[float, float, float], verdict: str
) -> None:
    scene = "tumbled_1000_rest"
    found = judged(scene, pile(scene, dem=dem, rapier_stiff=(0.1, 5e-4, 4e-3)))[0]
    assert found.verdict == verdict
    assert f"{dem[0] / 0.1:.2g} of the cost" in found.measured


def test_a_pile_that_none_of_ours_ended_is_not_met() -> None:
    scene = "tumbled_1000_rest"
    found = pile(scene, rapier_stiff=(0.1, 5e-4, 4e-3))
    found[scene, "mean_depth_m"] += points("dem", (math.inf, 9), failed="not done after 9 CPU s")
    assert judged(scene, found)[0].verdict == "not met"


def test_a_pile_that_moves_is_to_be_on_the_front() -> None:
    on = pile("stones_100", dem=(3, 1e-5, 1e-4), rapier_stiff=(0.1, 1e-4, 1e-3))
    found = judged("stones_100", on)[0]
    assert found.verdict == "met" and "30 times Rapier's least" in found.measured
    behind = pile("stones_100", dem=(3, 1e-3, 1e-2), rapier_stiff=(0.1, 1e-4, 1e-3))
    assert judged("stones_100", behind)[0].verdict == "not met"


def test_dem_is_set_beside_every_point_of_the_front_of_seed_at_no_more_cost() -> None:
    some = points("seed", (0.1, 1), (0.2, 2), (0.01, 10)) + points("dem", (0.005, 0.5), (1e-4, 20))
    found = comparisons({("bounce", "apex_error_rel"): some})
    assert [round(each.ratio) for each in found] == [20, 2]  # what seed itself beats is left out
    verdict = judged("bounce", {("bounce", "apex_error_rel"): some})[-1]
    assert verdict.verdict == "not met" and "2 times less" in verdict.measured


def test_a_seed_that_is_cheaper_than_all_of_dem_counts_against_dem() -> None:
    some = points("seed", (0.1, 0.1)) + points("dem", (1e-9, 0.5))
    (found,) = comparisons({("bounce", "apex_error_rel"): some})
    assert found.dem is None and found.ratio == 0


def test_growth_takes_the_setting_of_most_piles_and_fits_a_power() -> None:
    found: Points = {}
    for count in (250, 1000, 4000):
        some = [Point("dem", "1/30", 1e-4, (1e-4 * count**1.5,))]
        if count < 4000:  # cheaper, and not done in the largest
            some.append(Point("dem", "1/10", 1e-4, (1e-5 * count,)))
        some.append(Point("seed", "any", math.inf, (9.0,), "not done"))
        found[f"pile_{count}", "mean_depth_m"] = some
    (line,) = growths(found)
    assert (line.setting, list(line.costs)) == ("1/30", [250, 1000, 4000])
    assert line.exponent == pytest.approx(1.5)


@pytest.mark.parametrize(
    ("falling", "lying", "failed", "verdict"),
    [
        (0.016, 0.001, "", "met"),
        (0.017, 0.001, "", "not met"),
        (0.001, 0.017, "", "not met"),
        (0.001, 0.001, "not done after 60 CPU s", "not met"),
    ],
)
def test_a_hundred_meshes_are_to_fall_and_lie_in_real_time(
    falling: float, lying: float, failed: str, verdict: str
) -> None:
    row = {"method": "dem", "shape": "stones", "bodies": "100", "points": "15000"}
    row |= {"frame_s": str(falling), "rest_frame_s": str(lying), "failed": failed}
    others = [row | {"method": "xpbd"}, row | {"bodies": "36"}, row | {"shape": "boxes"}]
    assert targets({}, others)[-1].verdict == "not measured"
    found = targets({}, [*others, row])[-1]
    assert found.verdict == verdict
    assert failed or "150 surface samples each" in found.measured


def table(scene_key: str, *rows: dict[str, Any]) -> str:
    """A CSV file of the bench with these cells, the others empty."""
    columns = columns_of(choose_scenes([scene_key])[0])
    buffer = io.StringIO()
    writer = csv.DictWriter(buffer, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return buffer.getvalue()


def test_tables_of_a_folder_give_the_newest_runs_of_each_setting(tmp_path: Path) -> None:
    row = {"method": "dem", "setting": "1/30", "cost_counts": "True", "machine": "here"}
    old = row | {"build": "old", "cpu_s_per_sim_s": 9.0, "apex_error_rel": 0.5}
    new = row | {"build": "new", "cpu_s_per_sim_s": 2.0, "apex_error_rel": 1e-4}
    lost = new | {"setting": "1/10", "failed": "bounce lost"}
    text = table("bounce", old, new, new | {"apex_error_rel": "", "cpu_s_per_sim_s": 4.0}, lost)
    (tmp_path / "bounce.csv").write_text(text + "bounce,cut-off")
    found = written_points(tmp_path, all_scenes())
    assert found["bounce", "apex_error_rel"] == [
        Point("dem", "1/30", 1e-4, (2.0, 4.0)),
        Point("dem", "1/10", 1e-4, (2.0,), "bounce lost"),
    ]
    assert found["drop", "height_error_m"] == []
    assert set(FEW_BODIES.items()) <= set(found)  # each is a measure of the chart
