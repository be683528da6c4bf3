# SPDX-License-Identifier: MIT
"""One clip with its provenance: simulate, render, and write clip.mp4 beside clip.json."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from verisim import engine
from verisim.engine import Overrides, Progress
from verisim.json_numbers import finite_numbers
from verisim.pose_log import PoseLog

SIDECAR_SCHEMA = 1


def make_clip(
    scene_path: Path | str,
    output: Path,
    *,
    overrides: Overrides = (),
    size: tuple[int, int] = (1280, 720),
    profile: str = "stimulus",
    gl: str = "auto",
    show: str = "mesh",
    poses: PoseLog | None = None,
    run: engine.Run | None = None,
    raster_threads: int = 2,
    extra: dict[str, Any] | None = None,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Simulates the scene (unless a `run` of it or foreign `poses` are given), renders it to
    `output` and writes the sidecar, OUTPUT with suffix .json. Returns the sidecar, which holds no
    times of day and no timings: the same input gives the same bytes. A failed run still gives
    its clip."""
    output.parent.mkdir(parents=True, exist_ok=True)
    if poses is None:
        run = run or engine.simulate(scene_path, overrides)
        poses = run.poses
    info = engine.render(
        scene_path,
        poses,
        output,
        overrides=overrides,
        size=size,
        profile=profile,
        gl=gl,
        show=show,
        raster_threads=raster_threads,
        progress=progress,
    )
    sidecar: dict[str, Any] = {"schema": SIDECAR_SCHEMA}
    scene = engine.load_scene(scene_path, overrides)
    sidecar |= {"scene": scene.name, "scene_sha256": engine.scene_sha256(scene)}
    if run is not None:
        untimed = ("engine_version", "method", "duration_s", "steps", "failed", "state_hash")
        sidecar |= {key: run.summary[key] for key in untimed}
        sidecar |= {"parameters": run.parameters, "metrics": run.summary["metrics"]}
        sidecar |= {"events": run.events}
    sidecar |= {"scene_yaml": scene.resolved_yaml, **info, **(extra or {})}
    write_json(output.with_suffix(".json"), sidecar)
    return sidecar


def write_json(file: Path, content: dict[str, Any]) -> None:
    """Writes one JSON object by rename: indented, UTF-8, keys in the order given, and null where
    a number is not finite."""
    temporary = file.with_name(f".{file.name}.{os.getpid()}.tmp")
    try:
        text = json.dumps(finite_numbers(content), indent=1, ensure_ascii=False, allow_nan=False)
        temporary.write_text(text + "\n", "utf-8")
        temporary.replace(file)
    finally:
        temporary.unlink(missing_ok=True)
