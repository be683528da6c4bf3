# SPDX-License-Identifier: MIT
"""Builds the clips of a set: in parallel, resumable, and nothing twice."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from verisim.stimuli.check import scene_problems
from verisim.stimuli.engine_build import engine_build
from verisim.stimuli.expand import Stimulus, content_key, expand
from verisim.stimuli.make_stimulus import Folder, Task, add_error, make_stimulus, read_finished
from verisim.stimuli.manifest import write_manifest, write_set_json
from verisim.stimuli.only_writer import only_writer
from verisim.stimuli.problems import SetError, StimuliError
from verisim.stimuli.set_file import load_set
from verisim.stimuli.workers import run_tasks

Progress = Callable[[float, float], None]  # (clips done, clips in all)


@dataclass(frozen=True)
class BuildResult:
    """What a build did; ids in the order of the manifest."""

    directory: Path
    built: list[str]
    kept: list[str]  # already there, byte for byte
    failed_runs: dict[str, str]  # clips whose physics failed, on purpose or not: id → code


def build_set(
    set_file: Path | str,
    out_dir: Path | str,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> BuildResult:
    """Makes every clip of the set in `out_dir`, with manifest.csv and set.json.

    jobs: worker processes, by default one per core. A finished clip with the same content key and
    the sha256 its sidecar names is kept. Raises SetError when set or scenes are wrong, before
    anything runs; StimuliError naming every stimulus that could not be made, after all others
    were. manifest.csv stands only beside a complete set.
    """
    stimulus_set = load_set(set_file)
    stimuli = expand(stimulus_set)
    if problems := scene_problems(stimulus_set, stimuli):
        raise SetError(problems)
    folder = Folder(Path(out_dir))
    with _only_build(folder):
        tasks = _tasks(stimuli, stimulus_set.profile, stimulus_set.size, folder)
        kept = [task.stimulus.id for task in tasks if read_finished(folder, task)]
        todo = [task for task in tasks if task.stimulus.id not in kept]
        if todo:
            folder.manifest.unlink(missing_ok=True)
        failures = _make(todo, len(kept), len(tasks), jobs or _num_cores(), progress)
        if failures:
            raise StimuliError(_failure_text(failures, len(tasks)))
        sidecars = [add_error(folder, stimulus) for stimulus in stimuli]
        keys = [task.content_key for task in tasks]
        write_set_json(folder, stimulus_set)
        write_manifest(folder, stimulus_set, stimuli, sidecars, keys)
    failed_runs = {
        stimulus.id: sidecar["failed"]["code"]
        for stimulus, sidecar in zip(stimuli, sidecars, strict=True)
        if sidecar["failed"]
    }
    built = [task.stimulus.id for task in todo]
    return BuildResult(folder.directory, built, kept, failed_runs)


def _tasks(
    stimuli: list[Stimulus], profile: str, size: tuple[int, int], folder: Folder
) -> list[Task]:
    engine = engine_build()
    return [
        Task(stimulus, folder, profile, size, content_key(stimulus, profile, size, engine))
        for stimulus in stimuli
    ]


def _make(
    tasks: list[Task], num_kept: int, total: int, jobs: int, progress: Progress | None
) -> dict[str, str]:
    """Runs the tasks; returns what went wrong by stimulus."""
    failures: dict[str, str] = {}
    shares = [0.0] * len(tasks)
    if progress:
        progress(num_kept, total)
    for event in run_tasks(tasks, make_stimulus, jobs):
        if event.kind == "fraction":
            shares[event.index] = event.value
        elif event.kind in ("done", "failed"):
            shares[event.index] = 1.0
        if event.kind == "failed":
            failures[tasks[event.index].stimulus.id] = event.value
        if progress:
            progress(num_kept + sum(shares), total)
    return failures


def _failure_text(failures: dict[str, str], total: int) -> str:
    lines = [f"{len(failures)} of {total} clips could not be made:"]
    lines += [f"{name}: {message}" for name, message in failures.items()]
    hint = "  hint: the other clips are kept; the same command goes on where this one stopped"
    return "\n".join([*lines, hint])


@contextmanager
def _only_build(folder: Folder) -> Iterator[None]:
    """Makes the folders, keeps other builds out, and clears what an interrupted build left."""
    for directory in (folder.directory, folder.clips, folder.poses):
        directory.mkdir(parents=True, exist_ok=True)
    with only_writer(folder.directory, "build", StimuliError):
        for directory in (folder.clips, folder.poses):
            for left_over in directory.glob(".*"):
                left_over.unlink()
        yield


def _num_cores() -> int:
    return len(os.sched_getaffinity(0))
