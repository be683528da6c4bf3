# SPDX-License-Identifier: MIT
"""Draws the cost of a pile against the number of its boxes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from verisim.analysis import style
from verisim.bench.chart.draw import OURS, PNG_DPI, WIDTH_IN, Drawing, looks
from verisim.bench.chart.growth import Growth, exponent_words, sizes
from verisim.bench.files import write_whole

NAME = "growth"
LEGEND_COLUMNS = 2


def draw_growth(lines: Sequence[Growth], folder: Path) -> Drawing:
    """Writes growth.svg and growth.png and returns the svg element for a page."""
    symbols = looks([line.method for line in lines])
    bottom = 0.55 + 0.18 * math.ceil(len(lines) / LEGEND_COLUMNS)
    height = 3.9 + bottom
    with style.look():
        figure = Figure(figsize=(WIDTH_IN, height))
        axes = figure.add_subplot()
        figure.subplots_adjust(left=0.115, right=0.97, top=0.97, bottom=bottom / height)
        axes.set_xscale("log")
        axes.set_yscale("log")
        titles = {}
        for number, line in enumerate(lines):
            look = symbols[line.method]
            titles[f"line{number}"] = _words(line)
            axes.plot(
                list(line.costs), list(line.costs.values()), color=look.color, lw=1.4, ms=7,
                ls="-" if line.method in OURS else (0, (3, 2)), gid=f"line{number}",
                label=f"{_name(line)}: $n^{{{exponent_words(line)}}}$", **look.symbol(),
            )  # fmt: skip
        counts = sizes(lines)
        axes.set_xticks(counts, [str(count) for count in counts])
        axes.xaxis.set_minor_locator(NullLocator())
        axes.set_xlabel("boxes")
        axes.set_ylabel("CPU seconds per simulated second")
        axes.tick_params(length=2)
        figure.legend(
            loc="lower left", bbox_to_anchor=(0.06, 0.05 / height), ncols=LEGEND_COLUMNS,
            fontsize=8, borderaxespad=0, handlelength=2.6,
        )  # fmt: skip
        svg = style.to_svg(figure, NAME, f"Cost against boxes, {len(lines)} contestants", titles)
        part, png = folder / f".{NAME}.part.png", folder / f"{NAME}.png"
        figure.savefig(part, dpi=PNG_DPI, metadata={"Software": None})
        part.replace(png)
    write_whole(folder / f"{NAME}.svg", f'<?xml version="1.0" encoding="utf-8"?>\n{svg}\n')
    return Drawing(svg, png)


def _name(line: Growth) -> str:
    return f"{line.method.replace('-', ', ', 1)}, {line.setting}"


def _words(line: Growth) -> str:
    costs = "; ".join(f"{count} boxes {cost:.3g} CPU s/s" for count, cost in line.costs.items())
    return f"{_name(line)}: {costs}"
