# SPDX-License-Identifier: MIT
"""Draws the figures of the report: ratings per clip, and ratings against cost or physical error."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter

from verisim.analysis import style
from verisim.analysis.codebook import Question
from verisim.analysis.tradeoff import COST, Measure

MAX_BUBBLE_CLIPS = 24  # beyond this, raw answers would make the page heavy and say little
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
RAIL_GAP = 0.07  # share of the axis width between the data and a rail


@dataclass(frozen=True)
class Drawing:
    """A figure ready for the page. note: what could not be drawn, as a sentence or empty."""

    name: str
    title: str
    svg: str
    note: str = ""
    group: str = ""  # figures of one group stand under a heading of their own


def scale_of(question: Question, values: pd.Series) -> tuple[float, float]:
    """Ends of the rating axis: the study's scale, or what was answered if it is not known."""
    low = question.minimum if question.minimum is not None else float(values.min())
    high = question.maximum if question.maximum is not None else float(values.max())
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def clip_label(stimulus: str) -> str:
    """A stimulus id in words: box_stack__stiffness-low__s1 → box stack · stiffness low · s1."""
    return " · ".join(part.replace("_", " ").replace("-", " ") for part in stimulus.split("__"))


def draw_scores(
    question: Question, scores: pd.DataFrame, ratings: pd.DataFrame, source: str
) -> Drawing:
    """One row per clip: raw answers as pale bubbles, mean with its 95 % interval in front.

    scores: rows of this question, of both participant sets. ratings: its participant × clip rows.
    """
    main = scores[scores["participants"] == "all"].sort_values("stimulus")
    clips = list(main["stimulus"])
    low, high = scale_of(question, ratings["value"])
    name, titles = f"scores-{_slug(question.key)}", {}
    with style.look():
        height = 0.85 + 0.42 * len(clips)
        figure, axes = style.new_figure(height)
        figure.subplots_adjust(left=0.05, right=0.95, top=1 - 0.32 / height, bottom=0.5 / height)
        _axis_words(axes, question, low, high)
        if len(clips) <= MAX_BUBBLE_CLIPS:
            _bubbles(axes, clips, ratings)
        for row, (_, score) in enumerate(main.iterrows()):
            gid = f"clip{row}"
            titles[gid] = f"{clip_label(score['stimulus'])}: {_score_words(score)}"
            _interval(axes, row, score, (low, high), gid)
            axes.annotate(
                clip_label(clips[row]),
                (0, row), xycoords=("axes fraction", "data"), xytext=(0, 7),
                textcoords="offset points", fontsize=9, color=style.INK, va="bottom", zorder=1.5,
                bbox={"facecolor": style.PAPER, "edgecolor": "none", "pad": 0.6},
            )  # fmt: skip
        others = scores[scores["participants"] != "all"].set_index("stimulus")["mean"]
        known = [(others[clip], row) for row, clip in enumerate(clips) if clip in others.index]
        if known:
            axes.plot(*zip(*known, strict=True), "|", ms=11, mew=1.6, color=style.WARNING)
        axes.set_ylim(len(clips) - 0.45, -0.75)
        axes.set_yticks([])
        axes.grid(axis="y", visible=False)
        axes.spines["left"].set_visible(False)
        style.write_heading(figure, question.key, source)
        alt = f"Mean rating of {len(clips)} clips on {question.key}; answers: {source}"
        return Drawing(name, question.key, style.to_svg(figure, name, alt, titles))


def draw_tradeoff(
    question: Question, measure: Measure, points: pd.DataFrame, source: str
) -> Drawing:
    """Mean rating with its interval against a measure on a log axis, one point per clip.

    points: rows of tradeoff.join_engine for this question. Failed runs are open markers on a rail
    at the right, zeros sit on a rail at the left, and clips without the measure are named.
    """
    points = points.sort_values("stimulus").reset_index(drop=True)
    low, high = scale_of(question, points["mean"])
    name = f"{_slug(measure.column)}-{_slug(question.key)}"
    scenes = sorted(set(points["scene"]))
    value = points[measure.column].astype(float)
    usable = ~points["failed"] & value.notna()
    titles: dict[str, str] = {}
    with style.look():
        legend_in = 0.2 * math.ceil(len(scenes) / 2)
        height = 3.3 + legend_in
        figure, axes = style.new_figure(height)
        figure.subplots_adjust(
            left=0.115, right=0.96, top=1 - 0.46 / height, bottom=(0.62 + legend_in) / height
        )
        rails = _log_axis(axes, value[usable], measure, failed=bool(points["failed"].any()))
        for row, point in points.iterrows():
            place = _place(point, measure.column, rails)
            if place is None:
                continue
            gid = f"point{row}"
            titles[gid] = _point_words(point, measure)
            _draw_point(axes, place, point, measure, scenes.index(point["scene"]), gid)
        _rating_axis(axes, question, low, high)
        axes.set_xlabel(measure.label)
        _scene_legend(axes, scenes)
        style.write_heading(figure, question.key, source)
        alt = f"{question.key} against {measure.title}; answers: {source}"
        svg = style.to_svg(figure, name, alt, titles)
    missing = points[~points["failed"] & value.isna()]
    title = f"{question.key} against {measure.title}"
    return Drawing(name, title, svg, _missing(missing, measure), measure.title)


def _missing(missing: pd.DataFrame, measure: Measure) -> str:
    if missing.empty:
        return ""
    names = ", ".join(
        clip_label(str(stimulus)) + (" (the reference itself)" if is_reference else "")
        for stimulus, is_reference in zip(missing["stimulus"], missing["is_reference"], strict=True)
    )
    return f"No figure for {measure.title}: {names}."


def _axis_words(axes: Axes, question: Question, low: float, high: float) -> None:
    margin = 0.04 * (high - low)
    axes.set_xlim(low - margin, high + margin)
    if high - low <= 10:
        axes.set_xticks(_ticks(low, high))
    if question.kind in ("bipolar", "choice"):  # just right; guessing
        axes.axvline((low + high) / 2, color="#9aa5b1", lw=1.2, zorder=1)
    left, right = question.ends
    for x, words, side in ((0, left, "left"), (1, right, "right")):
        axes.annotate(
            words, (x, 0), xycoords="axes fraction", xytext=(0, -28), textcoords="offset points",
            fontsize=9, color=style.MUTED, ha=side,
        )  # fmt: skip


def _bubbles(axes: Axes, clips: list[str], ratings: pd.DataFrame) -> None:
    counts = ratings.groupby(["stimulus", "value"]).size().reset_index(name="count")
    counts = counts[counts["stimulus"].isin(clips)]
    most = max(4, int(counts["count"].max()))  # one answer stays small where none repeats
    for count in sorted(set(counts["count"].tolist())):
        group = counts[counts["count"] == count]
        rows = [clips.index(clip) for clip in group["stimulus"]]
        size = 13.0 * math.sqrt(count / most)  # area follows the count
        axes.plot(group["value"], rows, "o", ms=size, color="#cfdce6", mew=0, zorder=2)


def _interval(axes: Axes, row: int, score: pd.Series, scale: tuple[float, float], gid: str) -> None:
    if not math.isnan(score["ci_low"]):
        ends = np.clip([score["ci_low"], score["ci_high"]], *scale)
        axes.plot(ends, [row, row], color=style.ACCENT, lw=2.4, solid_capstyle="round", zorder=3)
    axes.plot(
        [score["mean"]], [row], "o", ms=7, color=style.ACCENT, mec="white", mew=1, zorder=4, gid=gid
    )


def _score_words(score: pd.Series) -> str:
    text = f"mean {score['mean']:.2f}, n = {int(score['n'])}"
    if math.isnan(score["ci_low"]):
        return text
    return f"{text}, 95 % interval {score['ci_low']:.2f} to {score['ci_high']:.2f}"


@dataclass(frozen=True)
class _Rails:
    """Places on the x axis for what a log axis cannot hold; NaN = no such rail."""

    zero: float
    failed: float


def _log_axis(axes: Axes, value: pd.Series, measure: Measure, *, failed: bool) -> _Rails:
    """Set up a log axis around the positive values, with room for the rails that are needed."""
    positive = value[value > 0]
    low, high = (positive.min(), positive.max()) if len(positive) else (0.1, 1.0)
    start, end = math.log10(low), math.log10(high)
    pad = max(0.08, 0.08 * (end - start))
    if end - start < 0.5:  # show at least one labelled tick on either side
        pad = max(pad, 0.3)
    start, end = start - pad, end + pad
    has_zero = bool((value == 0).any())
    gap = RAIL_GAP * (end - start)
    zero = start - gap if has_zero else math.nan
    rail = end + gap if failed else math.nan
    axes.set_xscale("log")
    axes.set_xlim(
        10 ** (start - 2 * gap if has_zero else start), 10 ** (end + 2 * gap if failed else end)
    )
    _log_ticks(axes, start, end)
    for at, edge, words, side in (
        (zero, start, measure.zero, "left"),
        (rail, end, "failed run", "right"),
    ):
        if not math.isnan(at):
            axes.axvline(10**edge, color="#9aa5b1", lw=0.8, ls=(0, (2, 3)))
            axes.annotate(
                words, (10**at, 1), xycoords=("data", "axes fraction"), xytext=(0, 2),
                textcoords="offset points", ha="center" if side == "left" else "right",
                fontsize=8, color=style.MUTED,
            )  # fmt: skip
    return _Rails(10**zero, 10**rail)


def _log_ticks(axes: Axes, start: float, end: float) -> None:
    """Ticks between 10**start and 10**end only: a rail beyond them has no value on the axis."""
    decades = range(math.floor(start), math.ceil(end) + 1)
    within = [10.0**at for at in decades if start <= at <= end]
    every = max(1, math.ceil(len(within) / 6))
    major = within[::every]
    fine = [step * 10.0**at for at in decades for step in range(2, 10)]
    fine = [value for value in fine if start <= math.log10(value) <= end]
    if len(major) < 2:
        steps = (2, 5) if len(major) or end - start > 0.4 else range(2, 10)
        more = [step * 10.0**at for at in decades for step in steps]
        major += [value for value in more if start <= math.log10(value) <= end]
    axes.xaxis.set_major_locator(FixedLocator(sorted(major)))
    axes.xaxis.set_minor_locator(FixedLocator(fine if end - start <= 4 else []))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda at, _: _log_words(at)))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _log_words(value: float) -> str:
    """0.01, 0.2, 100; further out 10 with a raised exponent, with its factor if not 1."""
    exponent = math.floor(math.log10(value) + 1e-9)
    if -3 <= exponent <= 3:
        return f"{value:g}"
    factor = round(value / 10.0**exponent)
    power = "10" + str(exponent).translate(RAISED)
    return power if factor == 1 else f"{factor} × {power}"


def _place(point: pd.Series, column: str, rails: _Rails) -> float | None:
    if point["failed"]:
        return rails.failed
    value = float(point[column])
    if math.isnan(value):
        return None
    return rails.zero if value == 0 else value


def _draw_point(
    axes: Axes, x: float, point: pd.Series, measure: Measure, scene: int, gid: str
) -> None:
    color, marker = _scene_style(scene)
    y = point["mean"]
    if not math.isnan(point["ci_low"]):
        axes.plot([x, x], [point["ci_low"], point["ci_high"]], color=color, lw=1.3, alpha=0.75)
    quartiles = [float(point["cpu_s_per_sim_s_q1"]), float(point["cpu_s_per_sim_s_q3"])]
    if measure.column == COST and not point["failed"] and not np.isnan(quartiles).any():
        axes.plot(quartiles, [y, y], color=color, lw=1.3, alpha=0.75)
    axes.plot(
        [x], [y], marker, ms=7.5, gid=gid, mec=color, mew=1.6,
        mfc=style.PAPER if point["failed"] else color, zorder=4,
    )  # fmt: skip


def _point_words(point: pd.Series, measure: Measure) -> str:
    text = f"{clip_label(point['stimulus'])}: {_score_words(point)}"
    if point["failed"]:
        return f"{text}; run failed: {point['failed_code']}"
    return f"{text}; {measure.label} {point[measure.column]:.3g}"


def _rating_axis(axes: Axes, question: Question, low: float, high: float) -> None:
    margin = 0.06 * (high - low)
    axes.set_ylim(low - margin, high + margin)
    if high - low <= 10:
        axes.set_yticks(_ticks(low, high))
    if question.kind in ("bipolar", "choice"):
        axes.axhline((low + high) / 2, color="#9aa5b1", lw=1.2, zorder=1)
    axes.set_ylabel("reference chosen" if question.kind == "choice" else "mean rating")


def _ticks(low: float, high: float) -> np.ndarray:
    """Each point of a short scale; ends and middle of a share."""
    return np.linspace(0, 1, 3) if (low, high) == (0, 1) else np.arange(math.ceil(low), high + 0.5)


def _scene_style(index: int) -> tuple[str, str]:
    return style.COLORS[index % len(style.COLORS)], style.MARKERS[index % len(style.MARKERS)]


def _scene_legend(axes: Axes, scenes: list[str]) -> None:
    for index, scene in enumerate(scenes):
        color, marker = _scene_style(index)
        axes.plot([], [], marker, ms=6.5, color=color, label=scene.replace("_", " "))
    axes.figure.legend(
        loc="lower left", ncols=2, bbox_to_anchor=(0.09, 0.0), borderaxespad=0.15,
        handletextpad=0.2, columnspacing=1.4, labelspacing=0.35,
    )  # fmt: skip


def _slug(text: str) -> str:
    return "".join(char if char.isalnum() else "-" for char in text)
