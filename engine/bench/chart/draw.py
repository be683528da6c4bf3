# SPDX-License-Identifier: MIT
"""Draws error against cost: a symbol per contestant, failures on a rail, fronts as steps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import NullLocator

from verisim.analysis import style
from verisim.bench.chart.front import Point, front, quartiles, ties
from verisim.bench.files import write_whole

WIDTH_IN, TALL_IN = 7.4, 4.3
PNG_DPI = 160
LEGEND_COLUMNS = 4
EXACT = 1e-14  # below it an error is drawn on the rail of exact runs
OURS = {
    "dem": ("#0072b2", "o"),
    "dem-explicit": ("#3f8fc4", "D"),
    "xpbd": ("#00875f", "^"),
    "seed": ("#4a4f57", "s"),
}
ENGINES = {
    "mujoco": ("#d55e00", "v"),
    "bullet": ("#a3478b", "<"),
    "ode": ("#7a6a00", "P"),
    "rapier": ("#8c3b00", "X"),
    "jolt": ("#b8860b", ">"),
    "lammps": ("#c2185b", "*"),
}
FILL_STYLES = ("none", "full", "left", "bottom")  # of an engine's settings, in order


@dataclass(frozen=True)
class Look:
    color: str
    marker: str
    fill: str  # matplotlib's fill style

    def symbol(self) -> dict[str, Any]:
        return {
            "marker": self.marker,
            "mfc": "white" if self.fill == "none" else self.color,
            "mec": self.color,
            "mfcalt": "white",
            "fillstyle": "full" if self.fill == "none" else self.fill,
        }


@dataclass(frozen=True)
class Drawing:
    svg: str
    png: Path


def looks(methods: Sequence[str]) -> dict[str, Look]:
    """A symbol for each contestant: engines by colour and shape, their settings by filling."""
    found: dict[str, Look] = {}
    seen: dict[str, int] = {}
    for method in methods:
        if method in OURS:
            color, marker = OURS[method]
            found[method] = Look(color, marker, "full")
            continue
        engine = method.partition("-")[0]
        color, marker = ENGINES.get(engine, (style.MUTED, "h"))
        fill = FILL_STYLES[seen.get(engine, 0) % len(FILL_STYLES)]
        seen[engine] = seen.get(engine, 0) + 1
        found[method] = Look(color, marker, fill)
    return found


def draw_chart(
    name: str, label: str, points: Sequence[Point], folder: Path, *, alt: str
) -> Drawing:
    """Writes NAME.svg and NAME.png and returns the svg element for a page."""
    methods = list(dict.fromkeys(point.method for point in points))
    symbols = looks(methods)
    rows = math.ceil((len(methods) + 2) / LEGEND_COLUMNS)
    bottom = 0.6 + 0.172 * rows
    with style.look():
        height = TALL_IN + bottom
        figure = Figure(figsize=(WIDTH_IN, height))
        axes = figure.add_subplot()
        figure.subplots_adjust(
            left=0.85 / WIDTH_IN, right=1 - 0.15 / WIDTH_IN, top=1 - 0.5 / height,
            bottom=bottom / height,
        )  # fmt: skip
        rails = _scales(axes, points)
        titles: dict[str, str] = {}
        _draw_fronts(axes, points, symbols, rails)
        for number, point in enumerate(points):
            titles[f"point{number}"] = point_words(point)
            _draw_point(axes, point, symbols[point.method], rails, f"point{number}")
        _label(axes, label, rails)
        _legend(figure, methods, symbols, points)
        svg = style.to_svg(figure, name, alt, titles)
        part, png = folder / f".{name}.part.png", folder / f"{name}.png"
        figure.savefig(part, dpi=PNG_DPI, metadata={"Software": None})
        part.replace(png)
    write_whole(folder / f"{name}.svg", f'<?xml version="1.0" encoding="utf-8"?>\n{svg}\n')
    return Drawing(svg, png)


@dataclass(frozen=True)
class Rails:
    """Heights on the error axis for what has no finite error above 0."""

    failed: float
    exact: float | None
    top: float
    bottom: float


def _scales(axes: Axes, points: Sequence[Point]) -> Rails:
    errors = [point.error for point in points if point.counts and point.error > EXACT]
    has_exact = any(point.counts and point.error <= EXACT for point in points)
    low, high = (min(errors), max(errors)) if errors else (1e-3, 1.0)
    low, high = _decade(low * 0.7, math.floor), _decade(high * 1.4, math.ceil)
    decades = math.log10(high / low)
    lane = 10 ** (0.075 * max(decades, 1.5))
    axes.set_xscale("log")
    axes.set_yscale("log")
    rails = Rails(high * lane, low / lane if has_exact else None, high, low)
    axes.set_ylim((low / lane**2) if has_exact else low, high * lane**2)
    costs = [cost for point in points for cost in point.costs if 0 < cost < math.inf]
    if costs:
        axes.set_xlim(min(costs) / 1.6, max(costs) * 1.6)
    return rails


def _decade(value: float, rounded: object) -> float:
    assert callable(rounded)
    return float(10.0 ** rounded(math.log10(value)))


def _height(point: Point, rails: Rails) -> float:
    if not point.counts:
        return rails.failed
    if point.error <= EXACT:
        return rails.exact or rails.bottom
    return point.error


def _draw_point(axes: Axes, point: Point, look: Look, rails: Rails, gid: str) -> None:
    if not point.costs:
        return
    y = _height(point, rails)
    low, high = quartiles(point.costs)
    axes.plot([min(point.costs), high], [y, y], color=look.color, lw=0.9, alpha=0.55, zorder=3)
    axes.plot([low, high], [y, y], color=look.color, lw=2.2, alpha=0.55, zorder=3)
    axes.plot(
        [point.cost], [y], ls="none", ms=7 if look.marker != "*" else 9, mew=1.2,
        zorder=5, gid=gid, clip_on=False,
        **(look if point.counts else replace(look, fill="none")).symbol(),
    )  # fmt: skip


def _draw_fronts(
    axes: Axes, points: Sequence[Point], symbols: dict[str, Look], rails: Rails
) -> None:
    """Each contestant's own front in its colour, the front of all as a broad band behind."""
    _step(axes, _corners(front(points), rails), "#c9d3dc", 6.0, "-", 1.0)
    for method, look in symbols.items():
        own = front([point for point in points if point.method == method])
        line = "-" if method in OURS else (0, (3, 2))
        _step(axes, _corners(own, rails), look.color, 1.4, line, 2.0)
    for point in ties(points):
        axes.plot(
            [point.cost], [_height(point, rails)], marker="o", ms=13, mfc="none",
            mec=style.MUTED, mew=0.8, ls="none", zorder=2,
        )  # fmt: skip


def _corners(on: Sequence[Point], rails: Rails) -> list[tuple[float, float]]:
    return [(point.cost, _height(point, rails)) for point in on]


def _step(
    axes: Axes,
    corners: Sequence[tuple[float, float]],
    color: str,
    width: float,
    line: object,
    order: float,
) -> None:
    if not corners:
        return
    high = axes.get_ylim()[1]
    x = [cost for cost, _ in corners] + [axes.get_xlim()[1]]
    y = [height for _, height in corners]
    axes.step(x, [*y, y[-1]], where="post", color=color, lw=width, ls=line, zorder=order)
    axes.plot([x[0], x[0]], [y[0], high], color=color, lw=width, ls=line, zorder=order, alpha=0.35)


def _label(axes: Axes, label: str, rails: Rails) -> None:
    axes.set_xlabel("CPU seconds per simulated second")
    axes.set_ylabel(label)
    low, high = axes.get_ylim()
    axes.axhspan(rails.top, high, color="#fbeee8", zorder=0)
    decades = range(round(math.log10(rails.bottom)), round(math.log10(rails.top)) + 1)
    every = math.ceil(len(decades) / 9)
    ticks = [(10.0**power, f"$10^{{{power}}}$") for power in decades][::every]
    ticks.append((rails.failed, "failed"))
    if rails.exact is not None:
        axes.axhspan(low, rails.bottom, color="#eaf3ee", zorder=0)
        ticks.append((rails.exact, "exact"))
    axes.set_yticks([place for place, _ in ticks], [name for _, name in ticks])
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_ylim(low, high)
    left, right = axes.get_xlim()
    other = axes.secondary_xaxis("top", functions=(_inverse, _inverse))
    other.set_xlabel("times faster than real time", fontsize=9, color=style.MUTED, labelpad=5)
    other.tick_params(labelsize=8, length=2)
    other.spines["top"].set_visible(False)
    axes.set_xlim(left, right)


def _inverse(x: Any) -> Any:
    with np.errstate(divide="ignore"):
        return np.asarray(1 / np.asarray(x, dtype=float))


def _legend(
    figure: Figure, methods: Sequence[str], symbols: dict[str, Look], points: Sequence[Point]
) -> None:
    handles = [_handle(method, symbols[method]) for method in methods]
    handles.append(Line2D([], [], color="#c9d3dc", lw=6, label="front of all"))
    if ties(points):
        ring = Line2D([], [], ls="none", marker="o", ms=11, mfc="none", mec=style.MUTED)
        ring.set_label("tie: within the noise of costs")
        handles.append(ring)
    figure.legend(
        handles=handles, loc="lower left", ncols=LEGEND_COLUMNS, fontsize=8, borderaxespad=0,
        bbox_to_anchor=(0.06, 0.05 / figure.get_figheight()), columnspacing=1.4, handlelength=2.6,
    )  # fmt: skip


def _handle(method: str, look: Look) -> Line2D:
    line = "-" if method in OURS else (0, (3, 2))
    label = method.replace("-", ", ", 1)
    return Line2D(
        [], [], ls=line, lw=1.4, color=look.color, ms=6, label=label, **look.symbol(),
    )  # fmt: skip


def point_words(point: Point) -> str:
    """What a tooltip says."""
    words = f"{point.method}, {point.setting}: "
    words += f"FAILED ({point.failed})" if point.failed else f"error {point.error:.3g}"
    if point.costs:
        low, high = quartiles(point.costs)
        words += f" at {point.cost:.3g} CPU s/s (quartiles {low:.3g} to {high:.3g}, "
        words += f"least {min(point.costs):.3g}, {len(point.costs)} runs)"
    return words
