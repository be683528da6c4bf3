# SPDX-License-Identifier: MIT
"""`verisim simulate` with method dem: what it chose, contact events, the dump of a failed run."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from command_line import ROOT, Command

from verisim import engine
from verisim.pose_log import PoseLog

DROP = """\
schema: 1
name: drop
duration_s: 0.5
frame_rate_hz: 60
materials: {rubber: {density_kg_m3: 1000, restitution: 0.8, friction: 0.3}}
bodies:
  - {name: ball, shape: {sphere_radius_m: 0.1}, material: rubber, position_m: [0, 0, 0.4]}
ground: {plane: {normal: [0, 0, 1], offset_m: 0}, material: rubber}
"""


@pytest.fixture
def drop(tmp_path: Path) -> Path:
    """A ball that falls 0.3 m; the scene names no physics, so the method is dem."""
    file = tmp_path / "drop.yaml"
    file.write_text(DROP)
    return file


def test_a_scene_without_physics_says_what_dem_chose(verisim: Command, drop: Path) -> None:
    done = verisim("simulate", drop, "--json")
    assert done.returncode == 0, done.stderr
    summary = json.loads(done.stdout)
    assert summary["method"] == "dem"
    chosen = summary["chosen"]
    assert set(chosen) >= {"stiffness", "dt_s", "bound", "predicted_penetration_m"}
    assert chosen["max_penetration_m"] == pytest.approx(0.2e-3)
    assert chosen["bound"] == "impact"
    # A twentieth of what is allowed, for a ball alone; measured 1.0000e-5.
    assert chosen["predicted_penetration_m"] == pytest.approx(1e-5, rel=0.01)
    speed = math.sqrt(2 * 9.81 * 0.3)
    mass = summary["bodies"][0]["mass_kg"]
    assert chosen["stiffness"] == pytest.approx(mass * (speed / 1e-5) ** 2, rel=0.01)
    assert chosen["dt_s"] == summary["dt_s"]
    assert summary["metrics"]["num_samples"] == 1
    assert "num_particles" not in summary["metrics"]

    words = verisim("simulate", drop).stdout
    assert "allowed" in words and "under a resting load" in words and "(bound: impact)" in words


def test_the_end_of_a_contact_tells_its_restitution(drop: Path) -> None:
    run = engine.simulate(drop)
    begin, end = run.summary["events"][:2]
    assert (begin["kind"], end["kind"]) == ("contact_begin", "contact_end")
    assert begin["bodies"] == end["bodies"] == ["ball", "ground"]
    assert begin["approach_speed_m_s"] == pytest.approx(math.sqrt(2 * 9.81 * 0.3), rel=1e-3)
    assert end["approach_speed_m_s"] == begin["approach_speed_m_s"]
    assert end["restitution"] == pytest.approx(0.8, abs=0.01)
    assert end["contact_time_s"] == pytest.approx(end["time_s"] - begin["time_s"])
    assert end["time_s"] > begin["time_s"]


def test_a_failed_run_dumps_what_led_to_it(verisim: Command, drop: Path, tmp_path: Path) -> None:
    dump = tmp_path / "last.npz"
    soft = ("--set", "physics.stiffness_n_m=5000")  # 70 mm deep by energy
    done = verisim("simulate", drop, *soft, "--dump", dump, "--json")
    assert done.returncode == 1
    failed = json.loads(done.stdout)["failed"]
    assert failed["code"] == "penetration"
    assert str(dump) in done.stderr
    poses = PoseLog.load(dump)
    assert poses.names == ["ball"]
    assert poses.time_s[-1] == pytest.approx(failed["time_s"])
    assert poses.time_s[0] >= failed["time_s"] - 0.5 - 1e-9
    with np.load(dump, allow_pickle=False) as arrays:
        num_contacts = arrays["contact_time_s"].size
        assert num_contacts >= 1
        assert arrays["contact_bodies"].tolist()[-1] == ["ball", "ground"]
        assert arrays["contact_place_m"].shape == (num_contacts, 3)
        assert arrays["contact_normal"][-1].tolist() == [0, 0, 1]
        depth = 0.1 - poses.position_m[-1, 0, 2]
        assert arrays["contact_depth_m"][-1] == pytest.approx(depth)
        assert arrays["contact_load_n"][-1] > 0


def test_a_good_run_dumps_nothing(verisim: Command, drop: Path, tmp_path: Path) -> None:
    assert verisim("simulate", drop, "--dump", "last.npz").returncode == 0
    assert not (tmp_path / "last.npz").exists()
    assert verisim("simulate", drop, "--dump", "last.txt").returncode == 2


def test_a_ring_that_slides_onto_a_pole_does_not_pass_through_it(tmp_path: Path) -> None:
    # The ring's centre gets into the pole, but is no part of the ring.
    scene = tmp_path / "ring.yaml"
    scene.write_text(
        DROP.replace("bodies:", "gravity_m_s2: [0, 0, 0]\nbodies:").replace(
            "  - {name: ball, shape: {sphere_radius_m: 0.1}, material: rubber, "
            "position_m: [0, 0, 0.4]}\n",
            f"  - {{name: ring, shape: {{mesh: {ROOT}/stimuli/meshes/torus.obj}}, "
            "material: rubber, position_m: [0, 0, 2.5], velocity_m_s: [0, 0, -5]}\n"
            "  - {name: pole, shape: {box_m: [0.02, 0.02, 0.5]}, material: rubber, "
            "position_m: [0, 0, 2], motion: fixed}\n",
        )
    )
    run = engine.simulate(scene, ["duration_s=0.1"])
    assert run.summary["failed"] is None
    assert run.poses.position_m[-1, 0, 2] == pytest.approx(2)


def test_particles_of_dem_cannot_be_shown(verisim: Command, drop: Path) -> None:
    done = verisim("render", drop, "-o", "clip.mp4", "--show", "particles", "--size", "160x90")
    assert done.returncode == 1
    assert "method dem has no particles" in done.stderr
    done = verisim("view", drop, "--show", "particles")
    assert done.returncode == 1
    assert "method dem has no particles" in done.stderr
