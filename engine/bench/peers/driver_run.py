# SPDX-License-Identifier: MIT
"""Runs one peer on one scene in a process of its own and reads back its poses and its cost."""

from __future__ import annotations

import json
import math
import os
import shutil
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from verisim.bench.peers import lammps
from verisim.bench.peers.contestants import PeerConfig, cannot_pose
from verisim.bench.peers.install import driver_of, missing
from verisim.bench.peers.mjcf import mjcf
from verisim.bench.peers.rotation import quaternion_product
from verisim.bench.peers.scene import PeerScene
from verisim.engine import PoseLog

# Beyond the limit: reading, building (MuJoCo: a minute for 4000 bodies), a step without end.
GRACE_S, GRACE_PER_BODY_S = 20.0, 0.05
# Bullet, Jolt and Rapier look for contacts 20 mm ahead and were made for bodies of 0.1 to 10 m;
# smaller ones come in longer units, in which they are as wide as the boxes of a pile.
NEED_LONG_UNITS = ("bullet", "jolt", "rapier")
LEAST_WIDTH_M, USUAL_WIDTH_M = 0.1, 0.5
NUM_STATE = 13  # doubles of a body and frame: position, wxyz, velocity, angular velocity


@dataclass(frozen=True)
class PeerRun:
    """What one run gave. A run that failed holds the frames up to there."""

    poses: PoseLog
    cpu_s: float  # process CPU time of the stepping alone after the warm-up; one thread
    simulated_s: float  # simulated time that cpu_s paid for
    dt_s: float  # step taken: the frame interval over a whole number of steps
    version: str
    failed: str | None  # never raised: data


def steps_per_frame(scene: PeerScene, dt_s: float) -> int:
    """Least whole number of steps in a frame that are no longer than dt_s."""
    return max(1, math.ceil(1 / (scene.frame_rate_hz * dt_s) - 1e-6))


def length_unit(config: PeerConfig, scene: PeerScene) -> float:
    """Metres that the engine is given for one metre of the scene."""
    width = scene.smallest_body()
    is_small = config.engine in NEED_LONG_UNITS and width < LEAST_WIDTH_M * (1 - 1e-9)
    return USUAL_WIDTH_M / width if is_small else 1.0


def run_peer(
    config: PeerConfig,
    scene: PeerScene,
    dt_s: float,
    directory: Path,
    *,
    warm_up_s: float = 0,
    time_limit_s: float,
) -> PeerRun:
    """Runs one engine over the whole scene. The first `warm_up_s` of simulated time are stepped and
    logged but not timed. `time_limit_s`: wall-clock time of the stepping. Files go to a folder
    inside `directory` that is removed again. Anything that goes wrong is in `failed`."""
    steps = steps_per_frame(scene, dt_s)
    why = cannot_pose(config, scene) or missing(config.engine)
    if why is not None:
        return _run_of(scene, None, {"failed": why}, steps)
    grace_s = GRACE_S + GRACE_PER_BODY_S * len(scene.bodies)
    directory.mkdir(parents=True, exist_ok=True)
    folder = Path(tempfile.mkdtemp(prefix=f"{config.key}-", dir=directory)).resolve()
    try:
        unit = length_unit(config, scene)
        job = {
            **(scene.scaled(unit) if unit != 1 else scene).as_json(),
            "config": config.config,
            "dt_s": 1 / (scene.frame_rate_hz * steps),
            "steps_per_frame": steps,
            "num_frames": scene.num_frames(),
            "warm_up_frames": min(round(warm_up_s * scene.frame_rate_hz), scene.num_frames() - 1),
            "time_limit_s": time_limit_s,
        }
        if config.engine == "lammps":
            states, result = lammps.run(scene, job, folder, time_limit_s + grace_s)
            return _run_of(scene, states, result, steps)
        if config.engine == "mujoco":
            (folder / "model.xml").write_text(mjcf(scene, config.config, job["dt_s"]), "utf-8")
        (folder / "scene.json").write_text(json.dumps(job), "utf-8")
        result = _run_driver(driver_of(config), folder, time_limit_s + grace_s)
        states = _states_in(folder / "poses.bin", len(scene.bodies))
        if states is not None:
            states[:, :, 0:3] /= unit
            states[:, :, 7:10] /= unit
        return _run_of(scene, states, result, steps)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _run_driver(driver: Path, folder: Path, limit_s: float) -> dict[str, Any]:
    """Result of a driver's process; what it could not say itself is said here."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "RAYON_NUM_THREADS": "1"}
    started = time.monotonic()
    try:
        with (folder / "stderr.txt").open("wb") as stderr:
            done = subprocess.run(
                [driver, folder],
                cwd=folder,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=stderr,
                timeout=limit_s,
                check=False,
                env=environment,
            )
    except subprocess.TimeoutExpired:
        return {"failed": f"did not return within {time.monotonic() - started:.0f} s"}
    result_file = folder / "result.json"
    if result_file.exists():
        result: dict[str, Any] = json.loads(result_file.read_text("utf-8"))
        return result
    said = (folder / "stderr.txt").read_text("utf-8", "replace").strip().splitlines()
    last = f": {said[-1][:200]}" if said else ""
    return {"failed": f"driver ended with status {done.returncode}{last}"}


def _states_in(file: Path, num_bodies: int) -> np.ndarray[Any, np.dtype[np.float64]] | None:
    """[frames, bodies, 13], or None if the driver wrote nothing whole."""
    if not file.exists() or num_bodies == 0:
        return None
    values = np.fromfile(file, dtype="<f8")
    num_frames = values.size // (num_bodies * NUM_STATE)
    if num_frames == 0:
        return None
    states = values[: num_frames * num_bodies * NUM_STATE]
    return states.reshape(num_frames, num_bodies, NUM_STATE).astype(np.float64)


def _run_of(
    scene: PeerScene,
    states: np.ndarray[Any, np.dtype[np.float64]] | None,
    result: dict[str, Any],
    steps: int,
) -> PeerRun:
    """States of principal frames as poses of the scene's own."""
    if states is None:
        states = np.array([[_start_of(body) for body in scene.bodies]], dtype=np.float64)
        states = states.reshape(1, len(scene.bodies), NUM_STATE)
    frames = np.array([body.frame_wxyz for body in scene.bodies]).reshape(-1, 4)
    poses = PoseLog(
        names=[body.name for body in scene.bodies],
        time_s=np.arange(len(states)) / scene.frame_rate_hz,
        position_m=np.ascontiguousarray(states[:, :, 0:3]),
        orientation_wxyz=quaternion_product(states[:, :, 3:7], frames[None]),
        linear_velocity_m_s=np.ascontiguousarray(states[:, :, 7:10]),
        angular_velocity_rad_s=np.ascontiguousarray(states[:, :, 10:13]),
    )
    return PeerRun(
        poses=poses,
        cpu_s=float(result.get("cpu_s", 0.0)),
        simulated_s=float(result.get("simulated_s", 0.0)),
        dt_s=1 / (scene.frame_rate_hz * steps),
        version=str(result.get("version", "")),
        failed=result.get("failed"),
    )


def _start_of(body: Any) -> list[float]:
    return [
        *body.position,
        *body.orientation_wxyz,
        *body.linear_velocity,
        *body.angular_velocity,
    ]
