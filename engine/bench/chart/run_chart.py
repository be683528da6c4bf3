# SPDX-License-Identifier: MIT
"""Runs scenes over ladders, serially and interleaved, resumable; then draws charts and the page."""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from verisim.bench.chart.against_seed import comparisons
from verisim.bench.chart.bench_scene import BenchScene
from verisim.bench.chart.catalogue import all_scenes, choose_scenes
from verisim.bench.chart.contestants import Entry, choose_peers, own_entries, peer_entries
from verisim.bench.chart.front import Point
from verisim.bench.chart.growth import growths
from verisim.bench.chart.ladder import LADDERS, Ladder
from verisim.bench.chart.real_time import crowd_rows
from verisim.bench.chart.run_trial import HOPELESS, Task, run_trial
from verisim.bench.chart.tables import RunTable, inputs_hash, own_value, peers_hash, point_of
from verisim.bench.chart.targets import targets
from verisim.bench.chart.written_points import written_points
from verisim.bench.files import only_bench, write_whole
from verisim.bench.problems import BenchError
from verisim.stimuli.cost import machine
from verisim.stimuli.engine_build import engine_build
from verisim.stimuli.workers import run_tasks

Progress = Callable[[float, float], None]  # (seconds' worth of runs done, in all)
Say = Callable[[str], None]


@dataclass(frozen=True)
class Effort:
    """How much is measured."""

    repeats: tuple[tuple[float, int], ...]  # runs of a setting whose run takes less than so long, s
    limit_s: float  # CPU time of one run

    def runs(self, took_s: float) -> int:
        """Runs to make of a setting, the first included. Of a setting of several runs that are
        short the first only warms up."""
        return next(count for least, count in self.repeats if took_s < least)


SHORT_S = 2.0
CUT_OFF = ("not done", "time limit", "did not return")  # how such a failure begins
DEAR = 10  # times the limit, for references and for scenes whose every run is long
FULL = Effort(((SHORT_S, 11), (math.inf, 3)), 120.0)
QUICK = Effort(((0.3, 4), (SHORT_S, 3), (math.inf, 1)), 2.0)


@dataclass(frozen=True)
class Charted:
    """A scene with all its points, by measure."""

    scene: BenchScene
    points: dict[str, list[Point]]
    table: Path
    refused: dict[str, str]
    own: dict[str, dict[str, float]]  # measure -> contestant -> what its finest run gave


@dataclass(frozen=True)
class Result:
    directory: Path
    page: Path
    num_run: int
    num_kept: int
    charts: list[Charted]


def run_chart(
    directory: Path | str,
    *,
    scenes: Sequence[str] | None = None,
    methods: Sequence[str] | None = None,
    peers: Sequence[str] = (),
    quick: bool = False,
    progress: Progress | None = None,
    say: Say | None = None,
) -> Result:
    """Charts speed against accuracy into `directory`: SCENE.csv row by row, then figures, the
    page and run_log.json.

    A run made before with the same scene, setting, engine and machine is not made again. Raises
    BenchError for unknown names, or if another bench writes to the directory.
    """
    chosen = choose_scenes(scenes)
    if quick and not scenes:
        chosen = [scene for scene in chosen if not scene.is_dear]
    ladders = choose_ladders(methods)
    effort = QUICK if quick else FULL
    directory = Path(directory)
    with only_bench(directory):
        (directory / "index.html").unlink(missing_ok=True)
        (directory / "scenes").mkdir(exist_ok=True)
        say = say or (lambda _: None)
        engines = choose_peers(peers, say)
        session = Session(directory, effort, progress, say)
        plans = [session.plan(scene, ladders, engines, quick) for scene in chosen]
        for plan in plans:
            session.run(plan)
        charts = [plan.charted() for plan in plans]
        page = _show(directory, charts, quick, session)
    return Result(directory, page, session.num_run, session.num_kept, charts)


def choose_ladders(methods: Sequence[str] | None) -> list[Ladder]:
    """The ladders of these methods; None: all. Raises BenchError naming every unknown one."""
    known = {ladder.key: ladder for ladder in LADDERS}
    if unknown := [name for name in methods or () if name not in known]:
        raise BenchError(
            f"--methods: saw {', '.join(map(repr, unknown))}; allowed: {', '.join(known)}\n"
            "  hint: separate several methods by commas; other engines are named by --peers"
        )
    return [ladder for key, ladder in known.items() if methods is None or key in methods]


@dataclass
class Plan:
    """A scene, its entries and the runs made of each."""

    scene: BenchScene
    file: Path
    entries: list[Entry]
    table: RunTable
    identities: list[dict[str, str]]
    refused: dict[str, str]  # contestants that cannot pose the scene, and why

    def rows(self, index: int) -> list[dict[str, str]]:
        return self.table.of(self.identities[index])

    def finest(self, method: str) -> list[dict[str, str]]:
        """The runs of a contestant's own reference."""
        for i, entry in enumerate(self.entries):
            if entry.method == method and entry.is_finest:
                return self.rows(i)
        return []

    def charted(self) -> Charted:
        points = {
            measure.key: [
                point_of(entry, self.rows(i), measure, self.finest(entry.method))
                for i, entry in enumerate(self.entries)
                if not (measure.is_own and entry.is_finest)  # the reference itself
            ]
            for measure in self.scene.measures
        }
        refused = {**self.scene.not_posed, **self.refused}
        methods = dict.fromkeys(entry.method for entry in self.entries)
        own = {
            measure.key: {
                method: value
                for method in methods
                if (value := own_value(self.finest(method), measure)) is not None
            }
            for measure in self.scene.measures
            if measure.is_own
        }
        return Charted(self.scene, points, self.table.file, refused, own)


class Session:
    """One call of the bench: where it writes, what it measured."""

    def __init__(
        self, directory: Path, effort: Effort, progress: Progress | None, say: Say
    ) -> None:
        self.directory, self.effort, self.progress, self.say = directory, effort, progress, say
        self.machine, self.commit = machine(), _commit()
        self.engine = engine_build()
        self.num_run = self.num_kept = 0
        self.planned = self.done = 0.0

    def plan(
        self, scene: BenchScene, ladders: Sequence[Ladder], engines: Sequence[str], quick: bool
    ) -> Plan:
        file = scene.write(self.directory / "scenes")
        entries = own_entries(scene, file, ladders, quick=quick)
        others, refused = peer_entries(scene, file, engines, quick=quick)
        entries += others
        identities = [
            {
                "inputs_sha256": inputs_hash(scene, file, entry),
                "build": self._build(entry),
                "machine": self.machine,
            }
            for entry in entries
        ]
        table = RunTable(self.directory / f"{scene.key}.csv", scene)
        plan = Plan(scene, file, entries, table, identities, refused)
        self.planned += sum(self._missing(plan, i) for i in range(len(entries)))
        self.num_kept += sum(len(plan.rows(i)) for i in range(len(entries)))
        return plan

    def _build(self, entry: Entry) -> str:
        return peers_hash() if entry.is_peer else self.engine["build"][:16]

    def _missing(self, plan: Plan, index: int) -> int:
        """Runs still to make of a setting; before its first run as if it were short."""
        rows = plan.rows(index)
        if not rows:
            return self.effort.runs(0)
        if _is_lost(rows[0]):
            return 0
        return max(0, self.effort.runs(float(rows[0]["took_s"])) - len(rows))

    def run(self, plan: Plan) -> None:
        """First every setting once, for its errors; then rounds over all settings for costs, so
        that a slow minute of the machine hits all alike."""
        self.say(f"{plan.scene.key}: {len(plan.entries)} settings")
        entries = range(len(plan.entries))
        self._run(plan, [i for i in entries if not plan.rows(i)], judged=True)
        missing = [self._missing(plan, i) for i in entries]
        rounds = range(max(missing, default=0))
        self._run(plan, [i for n in rounds for i in entries if missing[i] > n], judged=False)

    def _run(self, plan: Plan, indices: Sequence[int], *, judged: bool) -> None:
        """Serially, in one worker process."""
        tasks = [self._task(plan, i, judged) for i in indices]
        for event in run_tasks(tasks, run_trial, 1):
            if event.kind in ("done", "failed"):
                index = indices[event.index]
                before = self._missing(plan, index)
                self._note(plan, index, event.kind, event.value)
                self.done += 1
                self.planned += self._missing(plan, index) + 1 - before
            if self.progress and event.kind != "started":
                share = event.value if event.kind == "fraction" else 0.0
                self.progress(self.done + share, max(self.planned, self.done + share))

    def _task(self, plan: Plan, index: int, judged: bool) -> Task:
        entry, scene = plan.entries[index], plan.scene
        is_dear = scene.is_dear or (scene.needs_reference and entry.is_finest)
        return Task(
            plan.file,
            entry.overrides,
            scene.measures if judged else (),
            scene.warm_up_s,
            self.effort.limit_s * (DEAR if is_dear else 1),
            entry.method if entry.is_peer else "",
        )

    def _note(self, plan: Plan, index: int, kind: str, value: Any) -> None:
        entry, rows = plan.entries[index], plan.rows(index)
        row: dict[str, Any] = (
            value if kind == "done" else {"failed": str(value).splitlines()[0], "took_s": 0}
        )
        plan.table.add(
            {
                **row,
                **plan.identities[index],
                "scene": plan.scene.key,
                "method": entry.method,
                "setting": entry.setting,
                "overrides": json.dumps(dict(entry.overrides)),
                "run": len(rows),
                "commit": self.commit,
                # The first run of a short one has cold caches and samples for its errors.
                "cost_counts": bool(rows) or float(row.get("took_s") or 0) >= SHORT_S,
            }
        )
        self.num_run += 1


def _is_lost(row: dict[str, str]) -> bool:
    """Whether repeating would tell nothing."""
    failed = row["failed"]
    return failed in HOPELESS or failed.startswith(CUT_OFF) or not row["cpu_s_per_sim_s"]


def _commit() -> str:
    """The commit of the checkout that this code lies in; empty outside of one."""
    here = Path(__file__).resolve().parent
    try:
        found = subprocess.run(
            ["git", "-C", str(here), "describe", "--always", "--dirty", "--abbrev=12"],
            capture_output=True, text=True, check=False, timeout=10,
        )  # fmt: skip
    except OSError:
        return ""
    return found.stdout.strip()


def _show(directory: Path, charts: Sequence[Charted], quick: bool, session: Session) -> Path:
    """Figures, the page and the log."""
    # Slow to import, and the workers need none of it.
    from verisim.bench.chart.draw import draw_chart
    from verisim.bench.chart.draw_growth import draw_growth
    from verisim.bench.chart.page import Overview, write_page

    figures = directory / "figures"
    figures.mkdir(exist_ok=True)
    drawings = {}
    for chart in charts:
        for number, measure in enumerate(chart.scene.measures):
            name = chart.scene.key if number == 0 else f"{chart.scene.key}__{measure.key}"
            points = chart.points[measure.key]
            alt = f"{chart.scene.title}: {measure.label} against cost, {len(points)} settings"
            drawings[chart.scene.key, measure.key] = draw_chart(
                name, measure.label, points, figures, alt=alt
            )
    facts = {
        "quick": quick,
        "machine": session.machine,
        "engine_version": session.engine["version"],
        "engine_build": session.engine["build"],
        "commit": session.commit,
        "runs": session.num_run + session.num_kept,
    }
    write_whole(directory / "run_log.json", json.dumps(facts, indent=2) + "\n")
    written = written_points(directory, all_scenes())
    lines = growths(written)
    overview = Overview(
        targets(written, crowd_rows(directory)),
        comparisons(written),
        lines,
        draw_growth(lines, figures).svg if lines else "",
    )
    page = directory / "index.html"
    write_page(page, charts, drawings, overview, facts)
    return page
