# SPDX-License-Identifier: MIT
"""`verisim simulate`, `shape` and `check` from the outside: arguments to stdout, status, files."""

from __future__ import annotations

import hashlib
import json
import math
from pathlib import Path

import numpy as np
import pytest
from command_line import ROOT, Command

from verisim import engine
from verisim.pose_log import PoseLog, PoseLogError

SUMMARY_KEYS = {
    "scene", "scene_sha256", "engine_version", "method", "duration_s", "steps", "dt_s", "cpu_s",
    "cpu_s_per_sim_s", "failed", "state_hash", "metrics", "bodies",
}  # fmt: skip
METRIC_KEYS = {
    "max_penetration_m", "mean_penetration_m", "energy_start_j", "energy_end_j",
    "kinetic_energy_j", "potential_energy_j", "elastic_energy_j", "damping_work_j",
    "friction_work_j", "energy_residual_rel", "momentum_residual_rel", "num_particles",
    "max_contacts",
}  # fmt: skip


def test_json_holds_every_promised_key(verisim: Command, bounce: Path) -> None:
    done = verisim("simulate", bounce, "--json")
    assert done.returncode == 0, done.stderr
    summary = json.loads(done.stdout)
    assert set(summary) >= SUMMARY_KEYS
    assert set(summary["metrics"]) >= METRIC_KEYS
    assert summary["failed"] is None
    assert summary["metrics"]["num_particles"] == 1
    (ball,) = summary["bodies"]
    assert ball["mass_kg"] == pytest.approx(1000 * 4 / 3 * math.pi * 0.1**3)
    assert len(ball["orientation_wxyz"]) == 4


def test_the_state_hash_is_of_the_final_state_and_does_not_depend_on_threads(
    bounce: Path,
) -> None:
    runs = [engine.simulate(bounce, num_threads=n) for n in (1, 2, 3)]
    assert len({run.summary["state_hash"] for run in runs}) == 1
    (body,) = runs[0].summary["bodies"]
    # A ball that never spins: its angular momentum is zero.
    state = np.array(
        [*body["position_m"], *body["orientation_wxyz"], *body["linear_velocity_m_s"], 0, 0, 0]
    )
    assert (
        hashlib.sha256(state.astype("<f8").tobytes()).hexdigest() == (runs[0].summary["state_hash"])
    )


def test_an_override_changes_the_run_and_the_scene_hash(verisim: Command, bounce: Path) -> None:
    plain = json.loads(verisim("simulate", bounce, "--json").stdout)
    moved = json.loads(
        verisim("simulate", bounce, "--set", "bodies.ball.position_m=[1,0,0.4]", "--json").stdout
    )
    assert moved["bodies"][0]["position_m"][0] == 1
    assert moved["scene_sha256"] != plain["scene_sha256"]


def test_a_failed_run_prints_its_object_and_exits_1(verisim: Command, bounce: Path) -> None:
    # Stability of the explicit step needs dt < 2 sqrt(m/k) = 0.03 s: 0.1 s blows up.
    done = verisim("simulate", bounce, "--set", "physics.dt_s=0.1", "--set", "duration_s=20",
                   "--json")  # fmt: skip
    assert done.returncode == 1
    failed = json.loads(done.stdout)["failed"]
    assert set(failed) >= {"code", "body", "time_s", "message"}
    assert failed["code"] in {"nonfinite", "energy_gain", "penetration", "pass_through"}


def test_poses_are_sampled_at_the_frame_rate_or_every_s(
    verisim: Command, bounce: Path, tmp_path: Path
) -> None:
    verisim("simulate", bounce, "--poses", tmp_path / "frames.npz")
    frames = PoseLog.load(tmp_path / "frames.npz")
    assert frames.names == ["ball"]
    np.testing.assert_allclose(frames.time_s, np.arange(31) / 60, atol=1e-9)
    verisim("simulate", bounce, "--poses", tmp_path / "fine.npz", "--every", "0.01")
    fine = PoseLog.load(tmp_path / "fine.npz")
    np.testing.assert_allclose(fine.time_s, np.arange(51) / 100, atol=1e-9)
    # Free fall until 0.247 s. Measured 1.0e-4: the semi-implicit step is off by g t dt / 2.
    falling = fine.time_s < 0.24
    expected = 0.4 - 9.81 * fine.time_s[falling] ** 2 / 2
    np.testing.assert_allclose(fine.position_m[falling, 0, 2], expected, atol=1.5e-4)


def test_a_broken_pose_log_is_refused_by_name(tmp_path: Path) -> None:
    file = tmp_path / "poses.npz"
    file.write_bytes(b"not an archive")
    with pytest.raises(PoseLogError, match=r"poses\.npz"):
        PoseLog.load(file)
    np.savez(file, names=np.array(["a"]), time_s=np.array([0.0, 1.0]))
    with pytest.raises(PoseLogError, match="position_m is missing"):
        PoseLog.load(file)


def test_every_scene_error_is_on_stderr_and_nothing_on_stdout(
    verisim: Command, bounce: Path
) -> None:
    bounce.write_text(bounce.read_text().replace("duration_s: 0.5", "duration: 0.5 s\nspin: 3"))
    done = verisim("simulate", bounce, "--json")
    assert done.returncode == 1
    assert done.stdout == ""
    assert "bounce.yaml:3: duration: saw an unknown key" in done.stderr
    assert "did you mean duration_s" in done.stderr
    assert "bounce.yaml:4: spin" in done.stderr
    assert "Traceback" not in done.stderr


def test_wrong_use_exits_2(verisim: Command) -> None:
    assert verisim("simulate").returncode == 2
    assert verisim("simulate", "a.yaml", "--no-such-option").returncode == 2
    assert verisim("render", "a.yaml", "-o", "clip.avi").returncode == 2


def test_a_prescribed_body_follows_its_pose_log(tmp_path: Path, bounce: Path) -> None:
    times = np.linspace(0, 0.5, 11)
    poses = PoseLog(
        names=["mover"],
        time_s=times,
        position_m=np.stack([times, 0 * times, 2 + 0 * times], axis=1)[:, None, :],
        orientation_wxyz=np.tile([1.0, 0, 0, 0], (11, 1, 1)),
        linear_velocity_m_s=np.tile([1.0, 0, 0], (11, 1, 1)),
        angular_velocity_rad_s=np.zeros((11, 1, 3)),
    )
    poses.save(tmp_path / "path.npz")
    text = bounce.read_text().replace(
        "ground:",
        "  - {name: mover, shape: {box_m: [0.1, 0.1, 0.1]}, material: rubber,\n"
        "     motion: {poses: path.npz}}\nground:",
    )
    bounce.write_text(text)
    run = engine.simulate(bounce)
    mover = run.poses.position_m[:, run.poses.names.index("mover")]
    np.testing.assert_allclose(mover[:, 0], run.poses.time_s, atol=1e-12)


def test_shape_reports_a_closed_mesh_exactly(verisim: Command) -> None:
    done = verisim("shape", ROOT / "stimuli/meshes/fox.obj", "--particle-size-m", 0.05, "--json")
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert report["closed"] is True
    assert report["num_triangles"] >= 500
    assert report["num_particles"] > 100
    assert report["problems"] == []
    inertia = np.array(report["inertia_m5"])
    assert np.allclose(inertia, inertia.T)


def test_shape_names_what_is_wrong_with_an_open_mesh(verisim: Command, tmp_path: Path) -> None:
    (tmp_path / "open.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\n")
    done = verisim("shape", "open.obj", "--json")
    assert done.returncode == 1
    report = json.loads(done.stdout)
    assert report["closed"] is False
    assert report["problems"]


def test_check_accepts_shipped_scenes_and_lists_problems_of_others(
    verisim: Command, bounce: Path
) -> None:
    assert verisim("check", bounce).returncode == 0
    bounce.write_text(bounce.read_text().replace("rubber, position", "ruber, position"))
    done = verisim("check", bounce)
    assert done.returncode == 1
    assert "bodies.ball.material" in done.stderr
