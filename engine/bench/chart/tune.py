# SPDX-License-Identifier: MIT
"""The cheapest setting of a scene that meets a bound, chosen from the scene's own front."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from ruamel.yaml import YAML

from verisim import engine
from verisim.bench.chart.contestants import resolve
from verisim.bench.chart.ladder import LADDERS, Ladder
from verisim.bench.problems import BenchError
from verisim.stimuli.trajectory_error import free_bodies, trajectory_error

FRAME_HEIGHT_PX = 720  # of the stimulus profile
REPEATS = (5, 40)  # of settings that may be the cheapest: at least, at most
ENOUGH_S = 0.2  # CPU time of a setting's runs, which ends the repeats
NEAR = 2.0  # times the cheapest: what is run again before one is chosen
COLD_S = 0.01  # CPU time of a run that its first time tells little of: all such are run again
REFERENCE_LIMIT_S = 600.0
LEAST_LIMIT_S = 5.0  # CPU time that any setting may take
LIMIT_FACTOR = 20.0  # times the cheapest run that meets the bound

Progress = Callable[[float, float], None]


@dataclass(frozen=True)
class Bound:
    """What is asked for: `kind` names the quantity, `most` its largest value.

    error_m: rms distance of centres of mass from the scene's finest run; penetration_m: deepest
    overlap; overlap_px: the same in pixels of a frame of 720 rows, at the body nearest to the
    camera; frame_s: CPU time of a frame that 95 of 100 frames stay within, where the setting of
    least error is taken.
    """

    kind: str
    most: float

    @property
    def needs_reference(self) -> bool:
        return self.kind in ("error_m", "frame_s")


@dataclass
class Candidate:
    """A setting that was run."""

    method: str
    setting: str
    overrides: dict[str, Any]  # by scene path
    costs: list[float] = field(default_factory=list)  # CPU s per simulated s
    values: dict[str, float] = field(default_factory=dict)  # by kind of bound
    failed: str = ""

    @property
    def cost(self) -> float:
        return median(self.costs) if self.costs else math.inf

    def meets(self, bound: Bound) -> bool:
        return not self.failed and self.values.get(bound.kind, math.inf) <= bound.most


@dataclass(frozen=True)
class Tuned:
    """What was found. `chosen` is None if nothing meets the bound."""

    scene: Path
    bound: Bound
    candidates: list[Candidate]
    chosen: Candidate | None
    again: Candidate | None  # the chosen setting, run once more
    reference: str  # the setting that errors are against; empty if no error was asked for

    @property
    def holds(self) -> bool:
        return self.again is not None and self.again.meets(self.bound)

    def front(self) -> list[Candidate]:
        """Settings that none cheaper betters in the bound's quantity (real time: in error)."""
        kind = "error_m" if self.bound.kind == "frame_s" else self.bound.kind
        best: list[Candidate] = []
        for each in sorted(self.candidates, key=lambda c: (c.cost, c.values.get(kind, math.inf))):
            if each.failed or not math.isfinite(each.values.get(kind, math.inf)):
                continue
            if not best or each.values[kind] < best[-1].values[kind]:
                best.append(each)
        return best


class TooSlow(Exception):
    """The run used up its time."""


def tune(
    scene: Path,
    bound: Bound,
    *,
    methods: Sequence[str] | None = None,
    progress: Progress | None = None,
) -> Tuned:
    """Runs the ladder of the scene's method (or of `methods`) on the scene and chooses.

    Errors are against the finest rung of the first method. Raises BenchError for unknown methods,
    for a scene without camera where pixels are asked for, or if the reference itself fails.
    """
    document = YAML(typ="safe").load(engine.load_scene(scene).resolved_yaml)
    ladders = _ladders(document, methods)
    if bound.kind == "overlap_px" and "camera" not in document:
        raise BenchError(
            f"{scene}: --max-overlap-px needs a camera, the scene names none\n"
            "  hint: add camera: {position_m: …, look_at_m: …}, or bound --max-penetration-m"
        )
    is_live = bound.kind == "frame_s"
    candidates = _candidates(scene, ladders, bound.most * (1 + 1e-9) if is_live else math.inf)
    finest = next((n for n, (_, is_finest) in enumerate(candidates) if is_finest), 0)
    session = _Session(scene, document, bound)
    found = [candidate for candidate, _ in candidates]
    total, done = len(found) + 2.0, 0.0
    if bound.needs_reference:
        session.set_reference(found[finest])
    order = [n for n in range(len(found)) if not (bound.needs_reference and n == finest)]
    for n in order:
        session.run(found[n])
        done += 1
        if progress:
            progress(done, total)
    _repeat(session, found, bound)
    chosen = _choose(found, bound)
    again = None
    if chosen is not None:
        again = Candidate(chosen.method, chosen.setting, chosen.overrides)
        session.run(again)
    if progress:
        progress(total, total)
    name = f"{found[finest].method}: {found[finest].setting}" if bound.needs_reference else ""
    return Tuned(scene, bound, found, chosen, again, name)


def _ladders(document: Mapping[str, Any], methods: Sequence[str] | None) -> list[Ladder]:
    known = {ladder.key: ladder for ladder in LADDERS}
    if methods is None:
        physics = document.get("physics", {})
        method = physics.get("method", "dem")
        methods = [f"{method}-explicit" if physics.get("integrator") == "explicit" else method]
    if unknown := [name for name in methods if name not in known]:
        raise BenchError(
            f"--methods: saw {', '.join(map(repr, unknown))}; allowed: {', '.join(known)}\n"
            "  hint: separate several methods by commas"
        )
    return [known[name] for name in methods]


def _candidates(
    scene: Path, ladders: Sequence[Ladder], longest_dt: float
) -> list[tuple[Candidate, bool]]:
    """Every rung that can be posed, and whether it is the reference. longest_dt: real time wants
    a step that ends with each frame."""
    found = []
    for ladder in ladders:
        base = {f"physics.{key}": value for key, value in ladder.base.items()}
        for rung in ladder.rungs:
            overrides = resolve(scene, base, rung)
            if overrides is None or float(overrides.get("physics.dt_s", 0)) > longest_dt:
                continue
            is_reference = rung.is_finest and ladder is ladders[0]
            found.append((Candidate(ladder.key, rung.name, overrides), is_reference))
    return found


class _Session:
    """Runs of one scene."""

    def __init__(self, scene: Path, document: dict[str, Any], bound: Bound) -> None:
        self.scene, self.document, self.bound = scene, document, bound
        self.free = free_bodies(engine.load_scene(scene).resolved_yaml)
        self.duration_s = float(document["duration_s"])
        self.reference: Any = None
        self.cheapest_s = math.inf  # CPU time of the cheapest run that meets the bound

    def set_reference(self, candidate: Candidate) -> None:
        run = self._simulate(candidate, REFERENCE_LIMIT_S)
        if run is None or candidate.failed:
            raise BenchError(
                f"{self.scene}: the finest run, which errors are against, did not succeed "
                f"({candidate.method}, {candidate.setting}: {candidate.failed})\n"
                "  hint: bound --max-penetration-m, which needs no reference"
            )
        self.reference = run.poses
        self._note(candidate, run)

    def run(self, candidate: Candidate) -> None:
        limit = max(LEAST_LIMIT_S, LIMIT_FACTOR * self.cheapest_s)
        run = self._simulate(candidate, min(limit, REFERENCE_LIMIT_S))
        if run is not None:
            self._note(candidate, run)

    def _simulate(self, candidate: Candidate, limit_s: float) -> engine.Run | None:
        begin = time.process_time()
        marks: list[float] = []

        def note(_done: float, _total: float) -> None:
            marks.append(time.process_time() - begin)
            if marks[-1] > limit_s:
                raise TooSlow

        interval = self.bound.most if self.bound.kind == "frame_s" else None
        try:
            run = engine.simulate(
                self.scene,
                candidate.overrides,
                sample_interval_s=interval,
                num_threads=1,
                progress=note,
            )
        except TooSlow:
            candidate.failed = f"not done after {limit_s:.3g} CPU s"
            return None
        failed = run.summary["failed"]
        candidate.failed = failed["code"] if failed else ""
        candidate.costs.append(float(run.summary["cpu_s_per_sim_s"] or math.inf))
        frames = np.diff([0.0, *marks])
        candidate.values["frame_s"] = float(np.percentile(frames, 95))
        return run

    def _note(self, candidate: Candidate, run: engine.Run) -> None:
        depth = float(run.summary["metrics"]["max_penetration_m"])
        candidate.values["penetration_m"] = depth
        if self.bound.kind == "overlap_px":
            candidate.values["overlap_px"] = depth * self._pixels_per_metre(run)
        if self.reference is not None:
            error = trajectory_error(run.poses, self.reference, self.free)
            candidate.values["error_m"] = math.inf if error is None else error
        if candidate.meets(self.bound):
            spent = candidate.costs[-1] * float(run.summary["duration_s"])
            self.cheapest_s = min(self.cheapest_s, spent)

    def _pixels_per_metre(self, run: engine.Run) -> float:
        """At the centre of mass that comes nearest to the camera."""
        camera = self.document["camera"]
        apart = run.poses.position_m - np.array(camera["position_m"], dtype=float)
        nearest = float(np.linalg.norm(apart, axis=-1).min())
        half_angle = math.radians(float(camera.get("fov_deg", 40))) / 2
        return FRAME_HEIGHT_PX / 2 / math.tan(half_angle) / nearest


def _repeat(session: _Session, candidates: Sequence[Candidate], bound: Bound) -> None:
    """More runs, in turn, of those that may be the cheapest: one run each is too noisy."""
    if bound.kind == "frame_s":
        return
    meeting = [candidate for candidate in candidates if candidate.meets(bound)]
    if not meeting:
        return
    least = min(candidate.cost for candidate in meeting)
    cold = COLD_S / session.duration_s
    close = [candidate for candidate in meeting if candidate.cost <= max(NEAR * least, cold)]
    few, many = REPEATS
    rounds = int(ENOUGH_S / max(least * session.duration_s, 1e-6))
    for _ in range(min(max(rounds, few), many) - 1):
        for candidate in close:
            session.run(candidate)


def _choose(candidates: Sequence[Candidate], bound: Bound) -> Candidate | None:
    meeting = [candidate for candidate in candidates if candidate.meets(bound)]
    if bound.kind == "frame_s":
        return min(meeting, key=lambda c: (c.values["error_m"], c.cost), default=None)
    return min(meeting, key=lambda c: c.cost, default=None)
