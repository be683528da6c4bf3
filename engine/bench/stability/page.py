# SPDX-License-Identifier: MIT
"""One HTML page with all maps, scores and misses; links to nothing outside."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from verisim.bench.files import write_whole
from verisim.bench.stability.catalogue import NOT_POSED
from verisim.bench.stability.cells import CODES, StabilityMap
from verisim.bench.stability.draw import Drawing, number_words
from verisim.bench.stability.score import Score, percent

ABOUT = {
    "stiffness_step": "Three boxes stand on each other. Too soft, their weight presses the springs "
    "in (crush); too long a step, the springs throw them out (blow-up).",
    "tower": "Boxes stand on each other, each 0.01 % of an edge aside. A tower on springs topples "
    "when its lowest contact is too deep for its height (buckling); particles on particles slide "
    "off their summits long before, because a viscous contact cannot hold a load aside.",
    "mass_ratio": "Two boxes. Springs that hold the upper one are stiff for the lower one, so its "
    "steps must be short.",
    "tunnelling": "A ball flies at a wall as thick as itself. It gets through if it steps over the "
    "wall, or if its energy presses it past the wall's middle.",
    "particle_size": "A weightless cube hits the ground. All of a face share its speed; a corner "
    "has one particle to stop it.",
    "restitution": "A ball bounces off the ground. Few steps per contact return the wrong speed.",
}


def write_page(
    file: Path,
    maps: Sequence[StabilityMap],
    drawings: Sequence[Drawing],
    scores: Sequence[Score],
    rows: Sequence[dict[str, Any]],
    facts: dict[str, Any],
) -> None:
    """Everything that was found, as one file that appears when it is complete."""
    environment = Environment(
        loader=FileSystemLoader([Path(__file__).parent, Path(__file__).parent.parent]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "percent": lambda part, whole: percent(part, whole).replace(" ", "\u00a0"),
        "number": number_words,
    }
    keys = list(dict.fromkeys(each.key for each in maps))
    panels: list[dict[str, Any]] = [
        {"of": of, "svg": Markup(drawing.svg), "score": score}  # our own drawing, words escaped
        for of, drawing, score in zip(maps, drawings, scores[:-1], strict=True)
    ]
    sections = [
        {
            "key": key,
            "title": next(each.title for each in maps if each.key == key),
            "about": ABOUT[key],
            "panels": [panel for panel in panels if panel["of"].key == key],
            "missing": [(method, why) for (name, method), why in NOT_POSED.items() if name == key],
        }
        for key in keys
    ]
    by_name = {(of.key, of.method): of for of in maps}
    misses = [
        {**row, "y": _row_words(by_name[row["map"], row["method"]], row["y"])}
        for row in rows
        if not row["right"]
    ]
    text = environment.get_template("stability.html.j2").render(
        sections=sections, scores=scores, total=scores[-1], misses=misses, facts=facts, codes=CODES
    )
    write_whole(file, text)


def _row_words(of: StabilityMap, y: float) -> str:
    return of.y_names(y) if of.y_names else number_words(y)
