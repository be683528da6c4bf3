# SPDX-License-Identifier: MIT
"""Draws one map: outcomes as colours and letters, what was predicted as lines, misses framed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.patheffects import Normal, Stroke

from verisim.analysis import style
from verisim.bench.files import write_whole
from verisim.bench.stability.cells import CODES, HOLDS, Line, StabilityMap
from verisim.bench.stability.tables import Cell, RunLog, is_right

FILL = {
    "ok": "#e4eef4",
    "S": "#0072b2",
    "X": "#b3372c",
    "T": "#8a4f9e",
    "D": "#c46a00",
    "J": "#7a6a00",
    "P": "#3c434b",
    "E": "#00806a",
    "?": "#ffffff",
}
LINE_STYLES = ((0, (5, 2)), (0, (1.5, 1.5)), (0, (7, 2, 1.5, 2)), (0, (3, 3)))
Array = npt.NDArray[np.float64]

CELL_IN = 0.25
LEAST_IN = 1.7  # height of the cells of a coarse map
PNG_DPI = 200


@dataclass(frozen=True)
class Drawing:
    name: str
    svg: str
    png: Path


def draw_map(of: StabilityMap, cells: Sequence[Cell], log: RunLog, folder: Path) -> Drawing:
    """Writes NAME.svg and NAME.png to `folder` and returns the svg element for a page."""
    xs = list(dict.fromkeys(cell.x for cell in cells))
    ys = list(dict.fromkeys(cell.y for cell in cells))
    titles: dict[str, str] = {}
    lines = of.lines()
    with style.look():
        num_rows = math.ceil((2 + len(lines)) / 2) + math.ceil(_num_codes(cells, log) / 5)
        bottom = 0.52 + 0.185 * num_rows
        left = 1.25 if of.y_names else 1.1 if min(ys) < 0.01 else 0.85  # as long as rows' names
        wide = style.WIDTH_IN - left - 0.12
        tall = max(CELL_IN * len(ys), LEAST_IN)
        height = tall + bottom + 0.12
        figure, axes = style.new_figure(height)
        figure.subplots_adjust(
            left=left / style.WIDTH_IN,
            right=1 - 0.12 / style.WIDTH_IN,
            top=1 - 0.12 / height,
            bottom=bottom / height,
        )
        for cell in cells:
            gid = f"cell{xs.index(cell.x)}x{ys.index(cell.y)}"
            titles[gid] = _words(cell, log)
            _draw_cell(axes, xs.index(cell.x), ys.index(cell.y), cell, log, gid)
        _draw_partition(axes, xs, ys, cells)
        handles = [_draw_line(axes, xs, ys, line, n) for n, line in enumerate(lines)]
        _label_axes(axes, of, xs, ys, wide)
        _legend(figure, cells, log, handles)
        svg = style.to_svg(figure, of.name, _alt(of, cells, log), titles)
        png = folder / f"{of.name}.png"
        part = folder / f".{of.name}.part.png"
        figure.savefig(part, dpi=PNG_DPI, metadata={"Software": None})
        part.replace(png)
    write_whole(folder / f"{of.name}.svg", f'<?xml version="1.0" encoding="utf-8"?>\n{svg}\n')
    return Drawing(of.name, svg, png)


def _outcome(cell: Cell, log: RunLog) -> str:
    return log.rows[cell.inputs_sha256]["outcome"]


def _num_codes(cells: Sequence[Cell], log: RunLog) -> int:
    return len({_outcome(cell, log) for cell in cells})


def _draw_cell(axes: Axes, x: int, y: int, cell: Cell, log: RunLog, gid: str) -> None:
    code = _outcome(cell, log)
    axes.add_patch(
        Rectangle((x - 0.5, y - 0.5), 1, 1, fc=FILL[code], ec="white", lw=0.6, gid=gid, zorder=1)
    )
    if code != HOLDS:
        ink = "white" if code != "?" else style.INK
        axes.text(x, y, code, color=ink, fontsize=7.5, ha="center", va="center_baseline", zorder=3)
    if not is_right(cell, log):
        axes.add_patch(
            Rectangle((x - 0.4, y - 0.4), 0.8, 0.8, fc="none", ec="#ffd23f", lw=2.2, zorder=4)
        )
        axes.add_patch(
            Rectangle((x - 0.45, y - 0.45), 0.9, 0.9, fc="none", ec=style.INK, lw=0.7, zorder=4)
        )


def _draw_partition(axes: Axes, xs: list[float], ys: list[float], cells: Sequence[Cell]) -> None:
    """The edges between cells of different predictions."""
    at = {(xs.index(cell.x), ys.index(cell.y)): cell.prediction.codes for cell in cells}
    for (x, y), codes in at.items():
        if at.get((x + 1, y), codes) != codes:
            axes.plot([x + 0.5] * 2, [y - 0.5, y + 0.5], color=style.INK, lw=1.8, zorder=3.5)
        if at.get((x, y + 1), codes) != codes:
            axes.plot([x - 0.5, x + 0.5], [y + 0.5] * 2, color=style.INK, lw=1.8, zorder=3.5)


def _draw_line(axes: Axes, xs: list[float], ys: list[float], line: Line, number: int) -> Line2D:
    x, y = _refined(line)
    (drawn,) = axes.plot(
        _index(xs, x),
        _index(ys, y),
        color="#c2185b" if number % 2 == 0 else "#5b1a7a",
        path_effects=[Stroke(linewidth=3.4, foreground="white", alpha=0.75), Normal()],
        ls=LINE_STYLES[number % len(LINE_STYLES)],
        lw=1.8,
        label=line.label,
        zorder=5,
        clip_on=True,
    )
    return drawn


def _refined(line: Line) -> tuple[Array, Array]:
    """More points along straight pieces (in logarithms): axes bend between cells."""
    count = 12 * (len(line.x) - 1) + 1
    places = np.linspace(0, len(line.x) - 1, count)
    known = np.arange(len(line.x))
    x = np.exp(np.interp(places, known, np.log(line.x)))
    y = np.exp(np.interp(places, known, np.log(line.y)))
    return x, y


def _index(values: list[float], at: Array) -> Array:
    """Places on an axis of cells, going on beyond its ends."""
    knots = np.array(values)
    if len(knots) < 2:
        return np.zeros_like(at)
    if knots.min() > 0:
        knots, at = np.log(knots), np.log(at)
    index = np.interp(at, knots, np.arange(len(knots)))
    first, last = knots[1] - knots[0], knots[-1] - knots[-2]
    index = np.where(at < knots[0], (at - knots[0]) / first, index)
    places: Array = np.where(at > knots[-1], len(knots) - 1 + (at - knots[-1]) / last, index)
    return places


def _label_axes(
    axes: Axes, of: StabilityMap, xs: list[float], ys: list[float], wide: float
) -> None:
    axes.set_xlim(-0.5, len(xs) - 0.5)
    axes.set_ylim(-0.5, len(ys) - 0.5)
    every = max(1, math.ceil(0.45 * len(xs) / wide))
    axes.set_xticks(range(0, len(xs), every), [number_words(x) for x in xs[::every]])
    names = of.y_names or number_words
    rows = 1 if of.y_names or len(ys) <= 13 else 2
    axes.set_yticks(range(0, len(ys), rows), [names(y) for y in ys[::rows]])
    axes.set_xlabel(of.x_label)
    axes.set_ylabel(of.y_label.replace(", ", "\n"))
    axes.grid(False)
    axes.tick_params(length=2)


RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number_words(value: float) -> str:
    """0.01, 0.25, 16, 390; far out 10⁻⁵ or 1.5·10⁵. Two digits that count."""
    if value == 0:
        return "0"
    exponent = math.floor(math.log10(abs(value)) + 1e-9)
    if -3 < exponent < 4:
        return f"{float(f'{value:.2g}'):g}"
    factor = f"{value / 10.0**exponent:.1f}".removesuffix(".0")
    power = f"10{str(exponent).translate(RAISED)}"
    return power if factor == "1" else f"{factor}·{power}"


def _legend(figure: Figure, cells: Sequence[Cell], log: RunLog, handles: Sequence[Artist]) -> None:
    seen = {_outcome(cell, log) for cell in cells}
    patches = [
        Patch(fc=FILL[code], ec="#9aa5b1", lw=0.5, label=_short(code))
        for code in CODES
        if code in seen
    ]
    wrong = Rectangle((0, 0), 1, 1, fc="none", ec="#ffd23f", lw=2.2, label="not as predicted")
    border = Line2D([], [], color=style.INK, lw=1.8, label="predicted border")
    low = 0.03 / figure.get_figheight()
    rows = math.ceil(len(patches) / 5)
    figure.legend(
        handles=[border, wrong, *handles], loc="lower left", ncols=2, fontsize=8,
        bbox_to_anchor=(0.02, low + 0.185 * rows / figure.get_figheight()), borderaxespad=0,
        columnspacing=1.4, handlelength=3.2, handletextpad=0.6, labelspacing=0.35,
    )  # fmt: skip
    figure.legend(
        handles=patches, loc="lower left", ncols=5, fontsize=8, bbox_to_anchor=(0.02, low),
        borderaxespad=0, columnspacing=1.1, handlelength=1.2, handletextpad=0.4,
        labelspacing=0.35,
    )  # fmt: skip


def _short(code: str) -> str:
    words = CODES[code].split(":")[0]
    return words if code == HOLDS else f"{code} {words}"


def _words(cell: Cell, log: RunLog) -> str:
    row = log.rows[cell.inputs_sha256]
    y = cell.of.y_names(cell.y) if cell.of.y_names else f"{cell.y:g}"
    text = f"{cell.x:g} × {y}: {row['outcome']}, predicted {cell.prediction.words}"
    if cell.prediction.limit != "none":
        text += f" ({cell.prediction.limit})"
    return text + (f"; {row['message']}" if row["message"] else "")


def _alt(of: StabilityMap, cells: Sequence[Cell], log: RunLog) -> str:
    right = sum(is_right(cell, log) for cell in cells)
    return f"{of.title}, method {of.method}: {right} of {len(cells)} cells as predicted"
