# SPDX-License-Identifier: MIT
"""All maps, chosen by name; and which cannot be posed for which method."""

from __future__ import annotations

from collections.abc import Sequence

from verisim.bench.problems import BenchError
from verisim.bench.stability.cells import METHODS, SPRINGS, StabilityMap
from verisim.bench.stability.column_maps import column_maps
from verisim.bench.stability.impact_maps import impact_maps
from verisim.bench.stability.xpbd_maps import xpbd_maps

NOT_POSED = {
    ("particle_size", "dem-explicit"): "Method dem has no particles: boxes meet by exact clipping, "
    "meshes by weighted surface points whose spacing no scene key sets.",
    ("particle_size", "dem-hybrid"): "As with dem-explicit.",
    ("particle_size", "xpbd"): "As with dem-explicit.",
    ("stiffness_step", "xpbd"): "Contacts of method xpbd are rigid: there is no stiffness to vary.",
}


def all_maps() -> list[StabilityMap]:
    return [*column_maps(), *impact_maps(), *xpbd_maps()]


def choose(maps: Sequence[str] | None, methods: Sequence[str] | None) -> list[StabilityMap]:
    """The maps of these names and methods, in the catalogue's order; None: all of them.

    Raises BenchError naming every unknown name.
    """
    every = all_maps()
    keys = list(dict.fromkeys(each.key for each in every))
    problems = [
        *(_unknown("map", name, keys) for name in maps or () if name not in keys),
        *(_unknown("method", name, list(METHODS)) for name in methods or () if name not in METHODS),
    ]
    if problems:
        raise BenchError("\n".join(problems))
    chosen = [
        each
        for each in every
        if (maps is None or each.key in maps) and (methods is None or each.method in methods)
    ]
    if not chosen:
        raise BenchError(
            f"no map of {', '.join(maps or keys)} can be posed for {', '.join(methods or METHODS)}"
            f"\n  hint: particle_size needs --methods seed, stiffness_step {' or '.join(SPRINGS)}"
            ".join(SPRINGS)}",
        )
    return chosen


def _unknown(what: str, name: str, allowed: list[str]) -> str:
    return (
        f"--{what}s: saw {name!r}; allowed: {', '.join(allowed)}\n"
        f"  hint: separate several {what}s by commas"
    )
