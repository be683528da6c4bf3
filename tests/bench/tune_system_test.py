# SPDX-License-Identifier: MIT
"""`verisim tune`: the bound is met, comments stay, wrong use is refused."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from verisim import engine
from verisim.bench.chart.write_physics import with_physics
from verisim.stimuli.trajectory_error import trajectory_error

Tune = Callable[..., "subprocess.CompletedProcess[str]"]
SCENE = """\
# A ball that bounces.
schema: 1
name: ball
duration_s: 1   # long enough for two bounces
materials:
  rubber: {density_kg_m3: 1000, restitution: 0.8}
bodies:
  - {name: ball, shape: {sphere_radius_m: 0.1},
     material: rubber, position_m: [0, 0, 0.6]}
physics:  # chosen by hand
  method: dem
  dt_s: 0.001  # far too fine
  contact_law: hunt_crossley   # stays

# The floor.
ground: {plane: {normal: [0, 0, 1]}, material: rubber}
camera: {position_m: [0, -2, 0.5], look_at_m: [0, 0, 0.3]}
"""


@pytest.fixture
def tune(tmp_path: Path) -> Tune:
    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "verisim", "tune", *map(str, arguments)],
            cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False,
        )  # fmt: skip

    (tmp_path / "ball.yaml").write_text(SCENE)
    return run


def test_the_cheapest_setting_that_meets_the_bound_is_written(tmp_path: Path, tune: Tune) -> None:
    done = tune("ball.yaml", "--max-error-m", 2e-3, "--json")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["met"] and found["written"]
    chosen = found["chosen"]
    meeting = [row for row in found["candidates"] if row.get("error_m", 1) <= 2e-3]
    assert chosen["cpu_s_per_sim_s"] == min(row["cpu_s_per_sim_s"] for row in meeting)
    assert len(meeting) < len(found["candidates"])  # the bound does exclude something

    # The file itself, run anew, is as near to the finest run as it was asked to be.
    reference = next(
        row for row in found["candidates"] if f"dem: {row['setting']}" == found["reference"]
    )
    (tmp_path / "fine.yaml").write_text(SCENE)
    fine = engine.simulate(tmp_path / "fine.yaml", reference["overrides"])
    tuned = engine.simulate(tmp_path / "ball.yaml")
    error = trajectory_error(tuned.poses, fine.poses, ["ball"])
    assert error == pytest.approx(chosen["error_m"]) and error <= 2e-3

    text = (tmp_path / "ball.yaml").read_text()
    for kept in SCENE.splitlines():
        if "dt_s" not in kept:
            assert kept in text.splitlines(), kept
    assert "# far too fine" in text
    assert tuned.parameters["dt_s"] == chosen["overrides"]["physics.dt_s"]


def test_a_dry_run_and_a_bound_out_of_reach_leave_the_scene_alone(
    tmp_path: Path, tune: Tune
) -> None:
    dry = tune("ball.yaml", "--max-penetration-m", 1e-3, "--dry-run")
    assert dry.returncode == 0, dry.stderr
    assert "bound met" in dry.stdout and "left as it is" in dry.stdout
    beyond = tune("ball.yaml", "--max-penetration-m", 1e-15)
    assert beyond.returncode == 1
    assert "no setting meets penetration_m <= 1e-15; the least found is" in beyond.stdout
    assert (tmp_path / "ball.yaml").read_text() == SCENE


def test_pixels_and_real_time_are_bounds_too(tune: Tune) -> None:
    seen = json.loads(tune("ball.yaml", "--max-overlap-px", 0.01, "--dry-run", "--json").stdout)
    again = seen["run_again"]
    # 360 rows / tan 20 degrees over 2 m to the ball, at its nearest.
    assert again["overlap_px"] == pytest.approx(again["penetration_m"] * 494.5, rel=0.02)
    assert again["overlap_px"] <= 0.01
    live = json.loads(tune("ball.yaml", "--real-time", 60, "--dry-run", "--json").stdout)
    assert live["met"]
    assert live["chosen"]["error_m"] == 0  # a ball's finest setting is far faster than real time
    assert all(row["overrides"]["physics.dt_s"] <= 1 / 60 + 1e-9 for row in live["candidates"])


def test_wrong_use_is_refused_with_what_is_allowed(tmp_path: Path, tune: Tune) -> None:
    for arguments in ((), ("--max-error-m", 1, "--real-time", 30)):
        done = tune("ball.yaml", *arguments)
        assert done.returncode == 2
        assert "exactly one of" in done.stderr and "hint:" in done.stderr
    method = tune("ball.yaml", "--max-error-m", 1, "--methods", "dam")
    assert method.returncode == 2 and "saw 'dam'" in method.stderr and "seed" in method.stderr
    (tmp_path / "blind.yaml").write_text(SCENE[: SCENE.index("camera")])
    blind = tune("blind.yaml", "--max-overlap-px", 1)
    assert blind.returncode == 2 and "needs a camera" in blind.stderr


def test_a_scene_in_braces_gets_physics_too() -> None:
    values = {"physics.dt_s": 0.1, "physics.method": "dem"}
    added = with_physics('{\n "name": "a"\n}\n', values)
    assert json.loads(added) == {"physics": {"dt_s": 0.1, "method": "dem"}, "name": "a"}
    changed = with_physics('{"name": "a", "physics": {"dt_s": 1, "substeps": 5}}\n', values)
    found = YAML(typ="safe").load(changed)["physics"]
    assert found == {"dt_s": 0.1, "substeps": 5, "method": "dem"}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("name: a\n", "name: a\nphysics: {dt_s: 0.1}\n"),
        ("name: a", "name: a\nphysics: {dt_s: 0.1}\n"),
        ("physics: {method: dem}  # why\nname: a\n", None),
        (
            "physics:\n  # why\n  dt_s: 1\n# end\nname: a\n",
            "physics:\n  # why\n  dt_s: 0.1\n# end\nname: a\n",
        ),
    ],
)
def test_settings_go_into_the_physics_block_alone(text: str, expected: str | None) -> None:
    found = with_physics(text, {"physics.dt_s": 0.1})
    if expected is None:
        assert found.startswith("physics: {method: dem, dt_s: 0.1}") and "# why" in found
        assert found.endswith("name: a\n")
    else:
        assert found == expected
