# SPDX-License-Identifier: MIT
"""One stimulus on disk: clip, sidecar and pose log, and whether they are whole."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from verisim.stimuli.expand import Stimulus, file_sha256
from verisim.stimuli.problems import StimuliError
from verisim.stimuli.trajectory_error import free_bodies, trajectory_error
from verisim.stimuli.workers import Report

# Of the work on a clip, for the progress bar; the rest is writing and hashing.
PHYSICS_SHARE, PICTURES_SHARE = 0.1, 0.85


@dataclass(frozen=True)
class Folder:
    """The layout of a stimulus directory."""

    directory: Path

    @property
    def clips(self) -> Path:
        return self.directory / "clips"

    @property
    def poses(self) -> Path:
        return self.directory / "poses"

    @property
    def manifest(self) -> Path:
        return self.directory / "manifest.csv"

    def clip(self, name: str) -> Path:
        return self.clips / f"{name}.mp4"

    def sidecar(self, name: str) -> Path:
        return self.clips / f"{name}.json"

    def pose_log(self, name: str) -> Path:
        return self.poses / f"{name}.npz"


@dataclass(frozen=True)
class Task:
    """What a worker needs to make one stimulus."""

    stimulus: Stimulus
    folder: Folder
    profile: str
    size: tuple[int, int]  # px
    content_key: str


def make_stimulus(task: Task, report: Report) -> None:
    """Simulates, renders and writes one stimulus; a run that fails still gives its clip."""
    from verisim import clip, engine

    stimulus, folder = task.stimulus, task.folder

    def physics(done: float, total: float) -> None:
        report(PHYSICS_SHARE * done / total)

    def pictures(done: float, total: float) -> None:
        report(PHYSICS_SHARE + PICTURES_SHARE * done / total)

    run = engine.simulate(stimulus.scene_file, stimulus.overrides, progress=physics)
    pose_log = folder.pose_log(stimulus.id)
    run.poses.save(pose_log)
    clip.make_clip(
        stimulus.scene_file,
        folder.clip(stimulus.id),
        overrides=stimulus.overrides,
        size=task.size,
        profile=task.profile,
        run=run,
        raster_threads=0,
        extra={
            "stimulus": stimulus.id,
            "overrides": dict(stimulus.overrides),
            "content_key": task.content_key,
            "poses_sha256": file_sha256(pose_log),
            "error_to_reference_m": None,  # known when the reference is made too: add_error
        },
        progress=pictures,
    )


def read_finished(folder: Folder, task: Task) -> dict[str, Any] | None:
    """The sidecar of a stimulus that is complete and made from the same content, else None."""
    name = task.stimulus.id
    try:
        sidecar: dict[str, Any] = json.loads(folder.sidecar(name).read_text("utf-8"))
        same = (
            sidecar.get("content_key") == task.content_key
            and sidecar.get("stimulus") == name
            and sidecar.get("video_sha256") == file_sha256(folder.clip(name))
            and sidecar.get("poses_sha256") == file_sha256(folder.pose_log(name))
        )
    except (OSError, ValueError, AttributeError):
        return None
    return sidecar if same else None


def add_error(folder: Folder, stimulus: Stimulus) -> dict[str, Any]:
    """Writes the distance to the reference's run into the sidecar; returns the sidecar."""
    from verisim.clip import write_json
    from verisim.pose_log import PoseLog, PoseLogError

    sidecar: dict[str, Any] = json.loads(folder.sidecar(stimulus.id).read_text("utf-8"))
    error = None
    if stimulus.reference:
        try:
            run, reference = (
                PoseLog.load(folder.pose_log(name)) for name in (stimulus.id, stimulus.reference)
            )
        except PoseLogError as problem:
            raise StimuliError(str(problem)) from problem
        error = trajectory_error(run, reference, free_bodies(sidecar["scene_yaml"]))
    if sidecar["error_to_reference_m"] != error:
        sidecar["error_to_reference_m"] = error
        write_json(folder.sidecar(stimulus.id), sidecar)
    return sidecar
