# SPDX-License-Identifier: MIT
"""A participant's whole order: practice, test units of the sampler, repeats, catch, layouts."""

from __future__ import annotations

import json
import random
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from verisim.study.server.samplers.sampler import Pool, Sampler, levels_of
from verisim.study.server.samplers.units import Unit, add_repeats, make_units, mix, separate
from verisim.study.server.stimulus_set import Stimulus


@dataclass(frozen=True)
class Between:
    """A factor of which each participant sees one level."""

    factor: str  # a factor of the set, or `scene`
    quota: int | None  # participants per level

    def level(self, stimulus: Stimulus) -> str:
        own = stimulus.scene if self.factor == "scene" else stimulus.factors.get(self.factor, "")
        return own

    def cells(self, stimuli: Sequence[Stimulus]) -> list[str]:
        if self.factor == "scene":
            return sorted({s.scene for s in stimuli if s.role == "test"})
        return levels_of(stimuli, self.factor)

    def of_cell(self, stimuli: Sequence[Stimulus], cell: str) -> list[Stimulus]:
        """Returns a cell's clips; practice and catch clips without a level belong to every cell."""
        kept = [s for s in stimuli if self.level(s) == cell]
        if self.factor == "scene":
            others = [s for s in stimuli if s.role != "test" and s.scene != cell]
            have = {s.role for s in kept}
            return kept + [s for s in others if s.role not in have]
        return kept + [s for s in stimuli if s.role != "test" and not self.level(s)]


@dataclass(frozen=True)
class Order:
    """All that `order` says in the study file."""

    sampler: Sampler
    seed: int
    separate_scenes: bool
    repeats: float  # share of test trials shown again
    pairs: str | None  # reference | all
    between: Between | None
    reclaim_after_min: int  # an unfinished list is handed out again after so many idle minutes

    def cells(self, stimuli: Sequence[Stimulus]) -> list[str]:
        return self.between.cells(stimuli) if self.between else [""]

    def pool(self, stimuli: Sequence[Stimulus], cell: str) -> Pool:
        own = self.between.of_cell(stimuli, cell) if self.between else list(stimuli)
        return Pool(make_units(own, "test", self.pairs), own, self.pairs)


@dataclass(frozen=True)
class PlannedTrial:
    """One trial of a participant's order, before it gets its number."""

    trial_kind: str  # practice | test | catch | repeat
    clips: tuple[str, ...]  # first or left first; none: chosen later
    layout: str
    track: str = ""
    target: str = ""  # of a pair, the clip that is right; of a catch trial, '' means: it is wrong

    def line(self) -> str:
        """This trial in the text whose hash is stored with the participant."""
        named = "\t".join(self.clips) or f"track {self.track}"
        more = f"\t{self.layout}" if self.layout != "single" else ""
        return f"{self.trial_kind}\t{named}{more}\n"


def plan_order(
    order: Order,
    stimuli: Sequence[Stimulus],
    layouts: Sequence[str],
    seed: str,
    list_no: int,
    cell: str,
) -> list[PlannedTrial]:
    """Returns a participant's trials in order. The same arguments give the same order."""
    rng = random.Random(seed)
    pool = order.pool(stimuli, cell)
    practice = make_units(pool.stimuli, "practice", order.pairs)
    catches = make_units(pool.stimuli, "catch", order.pairs)
    rng.shuffle(practice)
    rng.shuffle(catches)
    parts = order.sampler.parts(pool, list_no, rng)
    # Catch trials go where the order is free; a design that is all order takes them too.
    takers = [i for i, (_, fixed) in enumerate(parts) if not fixed] or list(range(len(parts)))
    main: list[Unit] = []
    for i, (units, fixed) in enumerate(parts):
        own = catches[takers.index(i) :: len(takers)] if i in takers else []
        block = mix(units, own, rng)
        main += separate(block, rng) if order.separate_scenes and not fixed else block
    if order.repeats:
        main = add_repeats(main, order.repeats, rng)
    layout_of = assign_layouts(len(main), layouts, list_no)
    planned = [plan_trial(unit, layouts[i % len(layouts)], rng) for i, unit in enumerate(practice)]
    # Of pairs, half show the manipulated clip first, whatever chance says.
    sides = balanced_sides(len(main), rng)
    planned += [
        plan_trial(unit, layout, rng, side)
        for unit, layout, side in zip(main, layout_of, sides, strict=True)
    ]
    return planned


def assign_layouts(num: int, layouts: Sequence[str], list_no: int) -> list[str]:
    """Returns the layout of each trial: one block per layout, which comes first takes turns."""
    turned = [layouts[(i + list_no) % len(layouts)] for i in range(len(layouts))]
    return [turned[i * len(turned) // max(num, 1)] for i in range(num)]


def balanced_sides(num: int, rng: random.Random) -> list[bool]:
    sides = [i % 2 == 0 for i in range(num)]
    rng.shuffle(sides)
    return sides


def plan_trial(
    unit: Unit, layout: str, rng: random.Random, swapped: bool | None = None
) -> PlannedTrial:
    clips = [clip.name for clip in unit.clips]
    target = ""
    if len(clips) == 2:
        target = clips[1] if unit.clips[0].reference or unit.kind != "test" else ""
        if rng.random() < 0.5 if swapped is None else swapped:
            clips.reverse()
    return PlannedTrial(unit.kind, tuple(clips), layout, unit.track, target)


def order_json(order: Order) -> dict[str, Any]:
    """Returns the order's keys for the stored configuration, without those left at nothing."""
    document = {
        "sampler": order.sampler.name,
        "seed": order.seed,
        "separate_scenes": order.separate_scenes,
        **asdict(order.sampler),
    }
    more = {"repeats": order.repeats, "pairs": order.pairs}
    document |= {key: value for key, value in more.items() if value}
    if order.between:
        document["between"] = asdict(order.between)
    return dict(json.loads(json.dumps(document)))
