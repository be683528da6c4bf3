# SPDX-License-Identifier: MIT
"""`verisim render`: a clip and its sidecar, the same bytes again, and nothing half-made."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import numpy as np
from command_line import Command

SMALL = ("--size", "160x90", "--set", "duration_s=0.2")


def test_a_clip_comes_with_a_sidecar_that_tells_its_provenance(
    verisim: Command, bounce: Path, tmp_path: Path
) -> None:
    done = verisim("render", bounce, "-o", "clip.mp4", *SMALL)
    assert done.returncode == 0, done.stderr
    clip = tmp_path / "clip.mp4"
    sidecar = json.loads((tmp_path / "clip.json").read_text())
    assert sidecar["video_sha256"] == hashlib.sha256(clip.read_bytes()).hexdigest()
    assert sidecar["num_frames"] == 13  # frame i shows time i / 60 s, 0 to 0.2 s
    assert (sidecar["width_px"], sidecar["height_px"]) == (160, 90)
    assert sidecar["metrics"]["num_particles"] == 1
    assert sidecar["parameters"]["dt_s"] == 1e-4
    assert {"scene", "scene_sha256", "engine_version", "method", "state_hash", "encoder"} <= set(
        sidecar
    )
    assert not [key for key in sidecar if "cpu" in key or key.endswith("_utc")]


def test_the_same_input_gives_the_same_bytes(
    verisim: Command, bounce: Path, tmp_path: Path
) -> None:
    for name in ("a", "b"):
        verisim("render", bounce, "-o", f"{name}.mp4", *SMALL)
    assert (tmp_path / "a.mp4").read_bytes() == (tmp_path / "b.mp4").read_bytes()
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()


def test_an_existing_clip_is_not_replaced_unasked(
    verisim: Command, bounce: Path, tmp_path: Path
) -> None:
    (tmp_path / "clip.mp4").write_text("precious")
    done = verisim("render", bounce, "-o", "clip.mp4", *SMALL)
    assert done.returncode == 1
    assert "--force" in done.stderr
    assert (tmp_path / "clip.mp4").read_text() == "precious"


def test_poses_from_elsewhere_are_drawn_as_they_are(
    verisim: Command, bounce: Path, tmp_path: Path
) -> None:
    np.savez(
        tmp_path / "other.npz",
        names=np.array(["ball"]),
        time_s=np.arange(5) / 60,
        position_m=np.tile([0.0, 0.0, 0.5], (5, 1, 1)),
        orientation_wxyz=np.tile([1.0, 0, 0, 0], (5, 1, 1)),
    )
    done = verisim("render", bounce, "-o", "clip.mp4", "--poses", "other.npz", "--size", "160x90")
    assert done.returncode == 0, done.stderr
    sidecar = json.loads((tmp_path / "clip.json").read_text())
    assert sidecar["num_frames"] == 5
    assert "metrics" not in sidecar  # nothing was simulated


def test_an_odd_size_is_refused_with_a_hint(verisim: Command, bounce: Path, tmp_path: Path) -> None:
    done = verisim("render", bounce, "-o", "clip.mp4", "--size", "161x90")
    assert done.returncode == 1
    assert "even" in done.stderr
    assert list(tmp_path.glob("*clip*")) == []
