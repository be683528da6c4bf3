# SPDX-License-Identifier: MIT
"""How many bodies can be simulated, and drawn, at 30 and at 60 frames per second."""

from __future__ import annotations

import json
import math
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from verisim import engine
from verisim.bench.chart.generated import EDGE_M, STONE, loose_stones, stacked_pile, stone_mesh
from verisim.bench.chart.ladder import Ladder
from verisim.bench.files import only_bench, table_text, whole_rows, write_whole
from verisim.stimuli.cost import machine
from verisim.stimuli.engine_build import engine_build

RATES_HZ = (60.0, 30.0)
LAYERS = 4
SIDES = (1, 2, 3, 4, 5, 7, 10, 14, 20, 28, 40)  # columns along each side: 4 to 6400 bodies
DURATIONS_S = {"boxes": 2.0, "stones": 4.0}  # long enough to come to rest
QUICK_SHARE = 0.5  # of them
MESH_METHODS = ("dem", "xpbd")  # that stones are run with: particles are counted with the boxes
SLOW_FRAME_S = 0.2  # beyond it no larger pile is tried
ALWAYS_UP_TO = {"boxes": 0, "stones": 100}  # bodies that are tried however slow; 100 are the target
LIMIT_S = 60.0  # CPU time of a run
FEW, MORE = 3, 13  # frames drawn in two clips, whose difference is the drawing alone
SIZE = (1280, 720)

Array = npt.NDArray[np.float64]
Say = Callable[[str], None]
Progress = Callable[[float, float], None]


@dataclass(frozen=True)
class Crowd:
    """A pile that was run."""

    method: str
    shape: str  # boxes | stones
    bodies: int
    points: int  # particles of seed, surface samples and corners of dem
    frame_s: float  # CPU time that 95 of 100 frames stay within
    rest_frame_s: float  # the same of the last quarter of the run
    median_frame_s: float
    draw_s: float | None  # wall time of drawing and encoding a frame; None: no OpenGL here
    failed: str


TABLE = "real_time.csv"
COLUMNS = tuple(field.name for field in fields(Crowd))


def crowd_rows(directory: Path) -> list[dict[str, str]]:
    """What an earlier call wrote there."""
    return whole_rows(directory / TABLE, COLUMNS)


@dataclass(frozen=True)
class Answer:
    method: str
    shape: str
    rate_hz: float
    simulated: float  # bodies, between the piles that were run; infinite: no pile was too large
    at_rest: float  # the same when they lie
    drawn_too: float | None  # simulated and drawn one after the other


@dataclass(frozen=True)
class RealTime:
    directory: Path
    page: Path
    crowds: list[Crowd]
    answers: list[Answer]


class TooSlow(Exception):
    """The pile is beyond real time by far."""


def run_real_time(
    directory: Path | str,
    ladders: Sequence[Ladder],
    *,
    quick: bool = False,
    progress: Progress | None = None,
    say: Say | None = None,
) -> RealTime:
    """Runs piles of growing number, of boxes and of meshes, with each method at its own choices and
    writes real_time.csv, a figure and a page. Raises BenchError if another bench writes there."""
    directory = Path(directory)
    races = [(ladder, "boxes") for ladder in ladders]
    races += [(ladder, "stones") for ladder in ladders if ladder.key in MESH_METHODS]
    share = QUICK_SHARE if quick else 1.0
    with only_bench(directory), tempfile.TemporaryDirectory() as scratch:
        (Path(scratch) / STONE).write_text(stone_mesh(), "utf-8")
        crowds: list[Crowd] = []
        for number, (ladder, shape) in enumerate(races):
            if say:
                say(f"real time: {ladder.label}, {shape}")
            for n, side in enumerate(SIDES):
                crowd = _run(ladder, shape, side, Path(scratch), share * DURATIONS_S[shape])
                crowds.append(crowd)
                if progress:
                    progress(number + (n + 1) / len(SIDES), len(races))
                if crowd.failed or (
                    crowd.frame_s > SLOW_FRAME_S and crowd.bodies >= ALWAYS_UP_TO[shape]
                ):
                    break
        answers = [
            answer
            for ladder, shape in races
            for rate in RATES_HZ
            if (answer := _answer(ladder.key, shape, rate, crowds))
        ]
        write_whole(directory / TABLE, table_text(COLUMNS, map(asdict, crowds)))
        page = _show(directory, crowds, answers)
    return RealTime(directory, page, crowds, answers)


def _run(ladder: Ladder, shape: str, side: int, folder: Path, duration_s: float) -> Crowd:
    make = stacked_pile if shape == "boxes" else loose_stones
    scene = make(side, LAYERS, duration_s)
    file = folder / f"{scene['name']}.yaml"
    file.write_text(json.dumps(scene), "utf-8")
    overrides: dict[str, Any] = {f"physics.{key}": value for key, value in ladder.base.items()}
    if ladder.key == "seed":
        overrides["physics.particle_size_m"] = EDGE_M / 4
    begin = time.process_time()
    marks = [begin]

    def note(_done: float, _total: float) -> None:
        marks.append(time.process_time())
        if marks[-1] - begin > LIMIT_S:
            raise TooSlow

    count = side**2 * LAYERS
    failed, points, draw_s = "", 0, None
    try:
        run = engine.simulate(file, overrides, num_threads=1, progress=note)
    except TooSlow:
        failed = f"not done after {LIMIT_S:g} CPU s"
    else:
        failed = run.summary["failed"]["code"] if run.summary["failed"] else ""
        metrics = run.summary["metrics"]
        points = int(metrics.get("num_samples") or metrics.get("num_particles") or 0)
        draw_s = _draw(file, run, folder)
    frames = np.diff(marks)[1:]  # the first builds the world
    slow, middle = _percentiles(frames)
    late, _ = _percentiles(np.empty(0) if failed else frames[-max(1, frames.size // 4) :])
    return Crowd(ladder.key, shape, count, points, slow, late, middle, draw_s, failed)


def _percentiles(frames: Array) -> tuple[float, float]:
    """What 95 of 100 stay within, and the median; infinite of none."""
    if frames.size == 0:
        return math.inf, math.inf
    slow, middle = np.percentile(frames, [95, 50])
    return float(slow), float(middle)


def _draw(file: Path, run: engine.Run, folder: Path) -> float | None:
    """Wall time of a frame of 1280 x 720: drawn off screen and encoded."""
    took = []
    for count in (FEW, MORE):
        poses = engine.PoseLog(run.poses.names, *(array[:count] for array in _arrays(run.poses)))
        begin = time.perf_counter()
        try:
            engine.render(file, poses, folder / "frames.mp4", size=SIZE, profile="preview")
        except engine.ClipError:
            return None
        took.append(time.perf_counter() - begin)
    return max(0.0, took[1] - took[0]) / (MORE - FEW)


def _arrays(poses: engine.PoseLog) -> list[Any]:
    return [
        poses.time_s,
        poses.position_m,
        poses.orientation_wxyz,
        poses.linear_velocity_m_s,
        poses.angular_velocity_rad_s,
    ]


def _answer(method: str, shape: str, rate_hz: float, crowds: Sequence[Crowd]) -> Answer | None:
    own = [crowd for crowd in crowds if (crowd.method, crowd.shape) == (method, shape)]
    held = [crowd for crowd in own if not crowd.failed or crowd.failed.startswith("not done")]
    if not held:
        return None
    bodies = [crowd.bodies for crowd in held]
    both: float | None = None
    drawn = [crowd for crowd in held if crowd.draw_s is not None]
    if drawn:
        both = crossing(
            [crowd.bodies for crowd in drawn],
            [crowd.frame_s + (crowd.draw_s or 0.0) for crowd in drawn],
            1 / rate_hz,
        )
    moving = crossing(bodies, [crowd.frame_s for crowd in held], 1 / rate_hz)
    lying = crossing(bodies, [crowd.rest_frame_s for crowd in held], 1 / rate_hz)
    return Answer(method, shape, rate_hz, moving, lying, both)


def crossing(bodies: Sequence[float], seconds: Sequence[float], limit: float) -> float:
    """Number of bodies at which a frame takes `limit`, straight in logarithms between the piles
    around it; 0 if the least pile is too slow, infinite if none is."""
    for n, value in enumerate(seconds):
        if value <= limit:
            continue
        if n == 0:
            return 0.0
        low, high = math.log(seconds[n - 1]), math.log(value)
        share = (math.log(limit) - low) / (high - low)
        return math.exp(
            math.log(bodies[n - 1]) + share * (math.log(bodies[n]) - math.log(bodies[n - 1]))
        )
    return math.inf


def _show(directory: Path, crowds: Sequence[Crowd], answers: Sequence[Answer]) -> Path:
    from verisim.bench.chart.draw_real_time import draw_real_time
    from verisim.bench.chart.page import write_real_time_page

    figures = directory / "figures"
    figures.mkdir(exist_ok=True)
    svg = draw_real_time(crowds, figures)
    page = directory / "real_time.html"
    facts = {"machine": machine(), **engine_build()}
    write_real_time_page(page, svg, crowds, answers, facts)
    return page
