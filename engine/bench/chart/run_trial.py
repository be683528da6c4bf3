# SPDX-License-Identifier: MIT
"""Runs one point of the chart once, in a worker process: costs, failure and errors as a row."""

from __future__ import annotations

import math
import signal
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from verisim.bench.chart.trial import Measure, Trial, scene_document
from verisim.engine import PoseLog

HOPELESS = ("nonfinite", "energy_gain", "pass_through")  # codes after which errors mean nothing
SPARSE = 4  # samples of a run that only costs count of


@dataclass(frozen=True)
class Task:
    """A run to make."""

    file: Path
    overrides: Mapping[str, Any]
    measures: tuple[Measure, ...]  # empty: a run for its cost alone
    warm_up_s: float
    limit_s: float  # of CPU time
    peer: str = ""  # engine-config; empty: our engine


class TooSlow(Exception):
    """The run used up its time."""


@dataclass(frozen=True)
class Finished:
    """A run of any engine."""

    poses: PoseLog | None
    cpu_s_per_sim_s: float
    simulated_s: float
    failed: str  # empty: none
    steps: int | None = None
    dt_s: float | None = None
    state_hash: str = ""
    version: str = ""


def run_trial(task: Task, report: Any) -> dict[str, Any]:
    """The row of a run, without what names it. Importable by name, as workers need it."""
    begin = time.monotonic()
    # A run that is stuck within a frame never looks at its limit: this ends the worker.
    signal.setitimer(signal.ITIMER_PROF, 3 * task.limit_s + 10)
    finished = _run_peer(task) if task.peer else _run_own(task, report)
    row: dict[str, Any] = {
        "cpu_s_per_sim_s": finished.cpu_s_per_sim_s,
        "simulated_s": finished.simulated_s,
        "steps": finished.steps,
        "dt_s": finished.dt_s,
        "state_hash": finished.state_hash[:16],
        "version": finished.version,
        "failed": finished.failed,
    }
    if finished.poses is not None and task.measures:
        row |= _judge(task, finished)
    signal.setitimer(signal.ITIMER_PROF, 0)
    row["took_s"] = time.monotonic() - begin
    return row


def _run_own(task: Task, report: Any) -> Finished:
    from verisim import engine

    clock = _Clock(task, report)
    scene = engine.load_scene(task.file, task.overrides)
    interval = None if task.measures else scene.duration_s / SPARSE
    if task.warm_up_s and interval is not None:
        interval = task.warm_up_s  # a sample where counting begins
    try:
        run = engine.simulate(
            task.file, task.overrides, sample_interval_s=interval, num_threads=1,
            progress=clock.note,
        )  # fmt: skip
    except TooSlow:
        reached = max(clock.reached_s, 1e-12)
        cost = clock.spent_s / reached
        return Finished(None, cost, reached, f"not done after {task.limit_s:g} CPU s")
    summary = run.summary
    failed = summary["failed"]
    cost = summary["cpu_s_per_sim_s"]
    if task.warm_up_s and clock.cost is not None:
        cost = clock.cost
    return Finished(
        run.poses,
        math.inf if cost is None else cost,
        float(run.poses.time_s[-1]),
        failed["code"] if failed else "",
        summary["steps"],
        summary["dt_s"],
        summary["state_hash"],
        summary["engine_version"],
    )


class _Clock:
    """Watches a run of ours: its time limit, and its cost after the warm-up."""

    def __init__(self, task: Task, report: Any) -> None:
        self.task, self.report = task, report
        self.begin = time.process_time()
        self.warm: tuple[float, float] | None = None  # simulated, CPU
        self.reached_s = self.spent_s = 0.0
        self.cost: float | None = None

    def note(self, done: float, total: float) -> None:
        now = time.process_time()
        self.reached_s, self.spent_s = done, now - self.begin
        self.report(done / total)
        if self.warm is None and done >= self.task.warm_up_s * (1 - 1e-9):
            self.warm = (done, now)
        elif self.warm is not None and done > self.warm[0]:
            self.cost = (now - self.warm[1]) / (done - self.warm[0])
        if self.spent_s > self.task.limit_s:
            raise TooSlow


def _run_peer(task: Task) -> Finished:
    from verisim.bench import peers

    engine, _, config = task.peer.partition("-")
    overrides = dict(task.overrides)
    dt = float(overrides.pop("dt_s"))
    scene = peers.peer_scene(task.file, overrides)
    with tempfile.TemporaryDirectory() as folder:
        run = peers.run_peer(
            peers.PeerConfig(engine, config), scene, dt, Path(folder),
            warm_up_s=task.warm_up_s, time_limit_s=task.limit_s,
        )  # fmt: skip
    poses = run.poses if run.poses is not None and run.poses.time_s.size else None
    cost = run.cpu_s / run.simulated_s if run.simulated_s > 0 else math.inf
    return Finished(
        poses, cost, run.simulated_s, run.failed or "", None, dt, "", f"{engine} {run.version}"
    )


def _judge(task: Task, finished: Finished) -> dict[str, Any]:
    """Errors by measure, and the failure that they show."""
    poses = finished.poses
    assert poses is not None
    finite = np.isfinite(poses.position_m).all() and np.isfinite(poses.linear_velocity_m_s).all()
    if not finite:
        return {"failed": finished.failed or "nonfinite"}
    trial = Trial(poses, scene_document(task.file), task.file.parent)
    return judge(trial, task.measures, finished.failed)


def judge(trial: Trial, measures: Sequence[Measure], failed: str) -> dict[str, Any]:
    """Every measure of a trial; `failed` names what was lost if the engine did not say so."""
    values: dict[str, Any] = {}
    for measure in measures:
        value = measure.evaluate(trial)
        values[measure.key] = value
        if not failed and not value < measure.lost_above and not measure.is_own:
            failed = measure.lost_words or "lost"
    return {**values, "failed": failed}
