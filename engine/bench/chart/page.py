# SPDX-License-Identifier: MIT
"""One HTML page with every chart, what each error level costs and what failed."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from verisim.bench.chart.against_seed import Comparison
from verisim.bench.chart.catalogue import all_scenes
from verisim.bench.chart.draw import Drawing
from verisim.bench.chart.front import Point, cheapest_within, front, ties
from verisim.bench.chart.growth import Growth, exponent_words, sizes
from verisim.bench.chart.targets import REAL_TIME, Target
from verisim.bench.files import write_whole

if TYPE_CHECKING:
    from verisim.bench.chart.real_time import Answer, Crowd
    from verisim.bench.chart.run_chart import Charted

LEVELS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)


@dataclass(frozen=True)
class Overview:
    """What the page says of several scenes together; of all tables in the folder."""

    targets: list[Target]
    against_seed: list[Comparison]
    growths: list[Growth]
    growth_svg: str  # empty: nobody was run on two piles


def write_page(
    file: Path,
    charts: Sequence[Charted],
    drawings: Mapping[tuple[str, str], Drawing],
    overview: Overview,
    facts: dict[str, Any],
) -> None:
    """Everything that was found, as one file that appears when it is complete."""
    environment = _environment()
    environment.filters["cost"] = cost_words
    environment.filters["error"] = lambda value: f"{value:.2g}"
    environment.filters["exponent"] = exponent_words
    sections = [_section(chart, drawings) for chart in charts]
    methods = list(
        dict.fromkeys(
            point.method for chart in charts for points in chart.points.values() for point in points
        )
    )
    text = environment.get_template("chart.html.j2").render(
        sections=sections,
        facts=facts,
        levels=LEVELS,
        methods=methods,
        overview=overview,
        growth_svg=Markup(overview.growth_svg),  # ours, words escaped
        sizes=sizes(overview.growths),
        verdicts=Counter(target.verdict for target in overview.targets),
        title_of={scene.key: scene.title for scene in all_scenes()}
        | {REAL_TIME: "Meshes in real time"},
    )
    write_whole(file, text)


def write_real_time_page(
    file: Path,
    svg: str,
    crowds: Sequence[Crowd],
    answers: Sequence[Answer],
    facts: dict[str, Any],
) -> None:
    """The figure, the answers and every pile, as one file."""
    environment = _environment()
    environment.filters["ms"] = milliseconds
    environment.filters["bodies"] = body_words
    text = environment.get_template("real_time.html.j2").render(
        svg=Markup(svg), crowds=crowds, answers=answers, facts=facts
    )
    write_whole(file, text)


def milliseconds(seconds: float | None) -> str:
    if seconds is None or math.isinf(seconds):
        return "–"
    return f"{1e3 * seconds:.0f}" if seconds >= 1 else f"{1e3 * seconds:.3g}"


def body_words(count: float | None) -> str:
    """A number of bodies, to two digits; as far as piles went."""
    if count is None:
        return "not drawn here"
    if math.isinf(count):
        return "more than tried"
    return "no" if count < 1 else f"{float(f'{count:.2g}'):.0f}"


def _environment() -> Environment:
    here = Path(__file__).parent
    return Environment(
        loader=FileSystemLoader([here, here.parent]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def _section(chart: Charted, drawings: Mapping[tuple[str, str], Drawing]) -> dict[str, Any]:
    panels = []
    for measure in chart.scene.measures:
        points = chart.points[measure.key]
        panels.append(
            {
                "measure": measure,
                "svg": Markup(drawings[chart.scene.key, measure.key].svg),  # ours, words escaped
                "front": front(points),
                "ties": ties(points),
                "levels": level_rows(points),
                "own": chart.own.get(measure.key, {}),
            }
        )
    first = chart.points[chart.scene.measures[0].key]
    return {
        "scene": chart.scene,
        "csv": chart.table.name,
        "refused": chart.refused,
        "panels": panels,
        "failed": [point for point in first if point.failed],
    }


@dataclass(frozen=True)
class LevelRow:
    """The cheapest setting of a contestant within each level of error."""

    method: str
    cells: list[Point | None]
    is_best: list[bool]  # of all contestants


def level_rows(points: Sequence[Point]) -> list[LevelRow]:
    methods = dict.fromkeys(point.method for point in points)
    of = {method: [point for point in points if point.method == method] for method in methods}
    best = [cheapest_within(points, level) for level in LEVELS]
    cells = {method: [cheapest_within(of[method], level) for level in LEVELS] for method in methods}
    return [
        LevelRow(method, row, [cell is not None and cell is best[n] for n, cell in enumerate(row)])
        for method, row in cells.items()
        if any(row)
    ]


def cost_words(seconds: float) -> str:
    """CPU time per simulated second, for people: 0.21 ms/s, 3.4 s/s."""
    return f"{seconds:.3g} s/s" if seconds >= 0.5 else f"{1e3 * seconds:.3g} ms/s"
