# SPDX-License-Identifier: MIT
"""The engine from Python: scenes in, metrics and pose arrays out, clips rendered."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from verisim import __version__, _engine
from verisim.last_moments import LAST_CONTACTS, LastMoments
from verisim.pose_log import PoseLog, PoseLogError

EngineError = _engine.EngineError
SceneError = _engine.SceneError
ClipError = _engine.ClipError
MeshError = _engine.MeshError

Overrides = Mapping[str, object] | Sequence[str]
Progress = Callable[[float, float], None]  # (done, total)

__all__ = [
    "ClipError",
    "EngineError",
    "LastMoments",
    "MeshError",
    "PoseLog",
    "PoseLogError",
    "Run",
    "SceneError",
    "check_scene",
    "inspect_shape",
    "load_scene",
    "render",
    "require_particles",
    "scene_sha256",
    "simulate",
]


@dataclass
class Run:
    """What one simulation gave."""

    summary: dict[str, Any]  # the object `verisim simulate --json` prints
    poses: PoseLog
    events: list[dict[str, Any]]  # contact events in order of time
    parameters: dict[str, Any]  # the physics as chosen, by scene key
    last: LastMoments | None = None  # what led to a failure, if it was asked for


def _override_list(overrides: Overrides) -> list[str]:
    if isinstance(overrides, Mapping):
        return [f"{path}={_as_yaml(value)}" for path, value in overrides.items()]
    return list(overrides)


def _as_yaml(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, list | tuple | np.ndarray):
        return "[" + ", ".join(_as_yaml(item) for item in value) + "]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{k}: {_as_yaml(v)}" for k, v in value.items()) + "}"
    return str(value)


def load_scene(scene_path: Path | str, overrides: Overrides = ()) -> _engine.Scene:
    """The scene, checked strictly. Raises SceneError with every problem at once."""
    scene = _engine.load_scene(str(scene_path), _override_list(overrides))
    for body, file in scene.prescribed_files():
        poses = PoseLog.load(Path(file))
        if body not in poses.names:
            raise PoseLogError(
                f"{file}: no body named {body}; it holds: {', '.join(poses.names)}\n"
                f"  hint: bodies.{body}.motion.poses needs a pose log with a body of that name"
            )
        index = poses.names.index(body)
        scene.set_prescribed(
            body,
            poses.time_s,
            np.ascontiguousarray(poses.position_m[:, index]),
            np.ascontiguousarray(poses.orientation_wxyz[:, index]),
            np.ascontiguousarray(poses.linear_velocity_m_s[:, index]),
        )
    return scene


def check_scene(scene_path: Path | str, overrides: Overrides = ()) -> None:
    """Raises what is wrong with a scene, its meshes and pose logs; runs nothing."""
    _engine.check_world(load_scene(scene_path, overrides))


def scene_sha256(scene: _engine.Scene) -> str:
    """Identity of a scene as run: the YAML with its overrides applied."""
    return hashlib.sha256(scene.resolved_yaml.encode()).hexdigest()


def simulate(
    scene_path: Path | str,
    overrides: Overrides = (),
    *,
    sample_interval_s: float | None = None,
    num_threads: int = 1,
    progress: Progress | None = None,
    keep_before_failure_s: float = 0,
) -> Run:
    """Runs a scene and returns metrics, events and poses (every frame, or every
    `sample_interval_s`). A run that fails returns too: `summary["failed"]` names code, body and
    time, and `last` holds what led to it, `keep_before_failure_s` long. Raises SceneError,
    MeshError or PoseLogError on bad input."""
    scene = load_scene(scene_path, overrides)
    result = _engine.simulate(
        scene, sample_interval_s, num_threads, progress, keep_before_failure_s
    )
    poses = _poses_of(scene.body_names, result)
    last = None
    if result.last is not None:
        contacts = {name: getattr(result.last, name) for name in LAST_CONTACTS}
        last = LastMoments(_poses_of(scene.body_names, result.last), contacts)
    summary = {
        "scene": scene.name,
        "scene_sha256": scene_sha256(scene),
        "engine_version": __version__,
        "method": scene.method,
        "duration_s": scene.duration_s,
        "steps": result.steps,
        "dt_s": result.dt_s,
        "cpu_s": result.cpu_s,
        "cpu_s_per_sim_s": result.cpu_s / result.simulated_s if result.simulated_s > 0 else None,
        "failed": result.failed,
        "state_hash": hashlib.sha256(result.final_state.astype("<f8").tobytes()).hexdigest(),
        "metrics": result.metrics,
        "chosen": result.chosen,
        "events": result.events,
        "bodies": result.bodies,
    }
    return Run(summary, poses, result.events, result.parameters, last)


def _poses_of(names: list[str], arrays: Any) -> PoseLog:
    return PoseLog(
        names=names,
        time_s=arrays.time_s,
        position_m=arrays.position_m,
        orientation_wxyz=arrays.orientation_wxyz,
        linear_velocity_m_s=arrays.linear_velocity_m_s,
        angular_velocity_rad_s=arrays.angular_velocity_rad_s,
    )


def render(
    scene_path: Path | str,
    poses: PoseLog,
    output: Path,
    *,
    overrides: Overrides = (),
    size: tuple[int, int] = (1280, 720),
    profile: str = "stimulus",
    gl: str = "auto",
    show: str = "mesh",
    raster_threads: int = 2,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Renders a pose log of the scene's bodies to an mp4 and returns what was done (backend,
    encoder settings, hashes). The file appears only when complete. Raises ClipError."""
    scene = load_scene(scene_path, overrides)
    if poses.names != scene.body_names:
        raise PoseLogError(
            f"the pose log's bodies are {', '.join(poses.names)}; "
            f"the scene's are {', '.join(scene.body_names)}"
        )
    require_particles(scene, show)
    info: dict[str, Any] = _engine.render_clip(
        scene,
        poses.time_s,
        poses.position_m,
        poses.orientation_wxyz,
        str(output),
        size[0],
        size[1],
        profile,
        gl,
        show,
        raster_threads,
        progress,
    )
    return info


def require_particles(scene: _engine.Scene, show: str) -> None:
    """Raises ClipError if particles are to be shown of a method that has none."""
    if show == "particles" and scene.method != "seed":
        raise ClipError(
            f"{scene.name}: method {scene.method} has no particles to show\n"
            "  hint: leave out --show particles, or name physics.method=seed"
        )


def inspect_shape(mesh: Path | str, particle_size_m: float | None = None) -> dict[str, Any]:
    """What the engine makes of a mesh: closed, volume, inertia, particles, problems."""
    report: dict[str, Any] = _engine.inspect_shape(str(mesh), particle_size_m)
    return report
