# SPDX-License-Identifier: MIT
"""How figures look and how they become SVG: small, the same bytes each time, no links outside."""

from __future__ import annotations

import io
import re
import zlib
from contextlib import AbstractContextManager
from html import escape
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure

INK, MUTED, GRID, PAPER = "#1f2933", "#66727f", "#e3e7eb", "#ffffff"
ACCENT, WARNING = "#1d5f8a", "#a8470b"
# Okabe and Ito's colours that keep 3:1 against white, in the order used.
COLORS = ("#0072b2", "#d55e00", "#00875f", "#a3478b", "#7a6a00", "#4a4f57", "#3f8fc4", "#8c3b00")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "p")
WIDTH_IN = 5.0  # 360 units wide: a phone shows a figure at its own size
ROOT_STYLE = (
    "font-family:system-ui,-apple-system,'Segoe UI',Roboto,'Noto Sans',sans-serif;"
    "stroke-linejoin:round"
)

RC: dict[str, Any] = {
    "svg.fonttype": "none",
    "font.family": "DejaVu Sans",
    "font.size": 10,
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 10,
    "axes.labelcolor": INK,
    "axes.edgecolor": "#9aa5b1",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.8,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelsize": 9,
    "ytick.labelsize": 9,
    "text.color": INK,
    "legend.frameon": False,
    "legend.fontsize": 9,
    "figure.facecolor": PAPER,
}


def look(hash_salt: str = "verisim") -> AbstractContextManager[None]:
    """The settings that every figure is drawn and saved under."""
    settings: Any = {**RC, "svg.hashsalt": hash_salt}
    return matplotlib.rc_context(settings)


def new_figure(height_in: float) -> tuple[Figure, Axes]:
    """An empty figure of the common width; use inside `with look()`."""
    figure = Figure(figsize=(WIDTH_IN, height_in))
    return figure, figure.add_subplot()


def write_heading(figure: Figure, title: str, source: str) -> None:
    """Title at the left of the top edge, whose answers these are at the right.

    Simulated answers are named in the warning colour.
    """
    simulated = source == "simulated"
    top = 1 - 4 / (72 * figure.get_figheight())
    figure.text(0.05, top, title, va="top", fontsize=11, fontweight="bold")
    figure.text(
        0.95,
        top,
        "simulated answers" if simulated else f"source: {source}",
        ha="right",
        va="top",
        fontsize=9,
        fontweight="bold" if simulated else "normal",
        color=WARNING if simulated else MUTED,
    )


def to_svg(figure: Figure, name: str, alt: str, titles: dict[str, str]) -> str:
    """The figure as an <svg> element: ids its own, `titles` (gid -> text) as tooltips."""
    buffer = io.BytesIO()
    with look(f"verisim-{name}"):
        figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    svg = buffer.getvalue().decode("utf-8")
    svg = svg[svg.index("<svg") :]
    for gid, text in titles.items():
        svg = svg.replace(f'<g id="{gid}">', f"<g><title>{escape(text)}</title>")
    svg = _slim(svg, f"{zlib.crc32(name.encode()):08x}-")
    head = f'<svg role="img" aria-label="{escape(alt, quote=True)}" style="{ROOT_STYLE}"'
    return svg.replace("<svg", head, 1).strip()


def _slim(svg: str, prefix: str) -> str:
    """Drop what draws nothing, which is half the bytes, and make the ids unique on a page."""
    svg = re.sub(r"<metadata>.*?</metadata>|<style.*?</style>|<!--.*?-->", "", svg, flags=re.DOTALL)
    svg = re.sub(r' transform="rotate\(-?0 [^"]*"', "", svg)
    svg = re.sub(r"font-family: [^;\"]*;? ?", "", svg)
    svg = re.sub(r"<[^>]*>", _round_numbers, svg)  # in tags only: words keep their digits
    used = set(re.findall(r'(?:href="#|url\(#)([^")]+)', svg))
    svg = re.sub(
        r' id="([^"]+)"', lambda found: f' id="{prefix}{found[1]}"' if found[1] in used else "", svg
    )
    svg = re.sub(r'(href="#|url\(#)', rf"\g<1>{prefix}", svg)
    svg = re.sub(r">\s+<", "><", svg)
    svg = svg.replace("<defs></defs>", "")
    return re.sub(r"\s+", " ", svg)


def _round_numbers(tag: re.Match[str]) -> str:
    return re.sub(r"-?\d+\.\d{3,}", lambda found: f"{float(found[0]):.2f}", tag[0])
