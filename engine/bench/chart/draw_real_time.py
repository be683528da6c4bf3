# SPDX-License-Identifier: MIT
"""Draws the time of a frame against the number of bodies."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from verisim.analysis import style
from verisim.bench.chart.draw import PNG_DPI, WIDTH_IN, looks
from verisim.bench.files import write_whole

if TYPE_CHECKING:
    from verisim.bench.chart.real_time import Crowd


def draw_real_time(crowds: Sequence[Crowd], folder: Path) -> str:
    """Writes real_time.svg and .png and returns the svg element."""
    methods = list(dict.fromkeys(crowd.method for crowd in crowds))
    symbols = looks(methods)
    with style.look():
        figure = Figure(figsize=(WIDTH_IN, 4.6))
        axes = figure.add_subplot()
        figure.subplots_adjust(left=0.115, right=0.97, top=0.96, bottom=0.2)
        axes.set_xscale("log")
        axes.set_yscale("log")
        for rate in (30, 60):
            axes.axhline(1 / rate, color=style.WARNING, lw=1.0, ls=(0, (4, 2)), zorder=1)
            axes.annotate(
                f"{rate} fps", (1, 1 / rate), xycoords=("axes fraction", "data"), fontsize=8,
                color=style.WARNING, ha="right", va="bottom", xytext=(-2, 1),
                textcoords="offset points",
            )  # fmt: skip
        for method, shape in dict.fromkeys((crowd.method, crowd.shape) for crowd in crowds):
            own = [
                crowd for crowd in crowds
                if (crowd.method, crowd.shape) == (method, shape) and crowd.frame_s < math.inf
            ]  # fmt: skip
            look = symbols[method]
            if shape == "stones":
                look = replace(look, fill="none")
            axes.plot(
                [crowd.bodies for crowd in own], [crowd.frame_s for crowd in own],
                color=look.color, lw=1.4, ms=6, ls="-" if shape == "boxes" else (0, (3, 2)),
                label=f"{method.replace('-', ', ', 1)}: {shape}", **look.symbol(),
            )  # fmt: skip
        drawn = {
            crowd.bodies: crowd.draw_s for crowd in crowds
            if crowd.draw_s is not None and crowd.shape == "boxes"
        }  # fmt: skip
        if drawn:
            axes.plot(
                sorted(drawn), [drawn[count] for count in sorted(drawn)], color=style.MUTED,
                lw=1.2, ls=(0, (2, 2)), marker=".", label="boxes drawn",
            )  # fmt: skip
        axes.set_xlabel("bodies")
        axes.set_ylabel("seconds a frame (95 of 100 frames)")
        axes.tick_params(length=2)
        figure.legend(loc="lower left", bbox_to_anchor=(0.1, 0.01), ncols=4, fontsize=8)
        svg = style.to_svg(figure, "real_time", "Seconds a frame against number of bodies", {})
        part = folder / ".real_time.part.png"
        figure.savefig(part, dpi=PNG_DPI, metadata={"Software": None})
        part.replace(folder / "real_time.png")
    write_whole(folder / "real_time.svg", f'<?xml version="1.0" encoding="utf-8"?>\n{svg}\n')
    return svg
