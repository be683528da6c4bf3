# SPDX-License-Identifier: MIT
"""What one trial can show: a clip, a pair of clips, or the next clip of an adaptive track."""

from __future__ import annotations

import itertools
import random
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from verisim.study.server.stimulus_set import Stimulus


@dataclass(frozen=True)
class Unit:
    """Clips that are shown in one trial; of a pair, the manipulated one and its standard."""

    clips: tuple[Stimulus, ...]  # none: an adaptive track chooses later
    kind: str = "test"
    track: str = ""
    scene: str = ""

    @property
    def name(self) -> str:
        return " | ".join(clip.name for clip in self.clips) or self.track


def single(stimulus: Stimulus) -> Unit:
    return Unit((stimulus,), stimulus.role, "", stimulus.scene)


def make_units(stimuli: Sequence[Stimulus], role: str, pairs: str | None) -> list[Unit]:
    """Returns what can be shown of a role, in an order that depends on names alone.

    pairs: None: each clip; `reference`: each clip beside its reference; `all`: every two clips of
    a scene. Practice and catch clips are paired with a reference clip of their scene.
    """
    chosen = sorted((s for s in stimuli if s.role == role), key=lambda s: s.name)
    if pairs is None:
        return [single(stimulus) for stimulus in chosen]
    if role == "test" and pairs == "all":
        return [
            Unit((a, b), role, "", a.scene)
            for a, b in itertools.combinations(chosen, 2)
            if a.scene == b.scene
        ]
    units: list[Unit] = []
    for stimulus in chosen:
        standard = find_standard(stimulus, stimuli)
        if standard is not None:
            units.append(Unit((stimulus, standard), role, "", stimulus.scene))
    return units


def find_standard(stimulus: Stimulus, stimuli: Sequence[Stimulus]) -> Stimulus | None:
    """Returns the clip that a pair compares this one with: its reference, or one of its scene."""
    if stimulus.reference:
        return next((s for s in stimuli if s.name == stimulus.reference), None)
    if stimulus.role == "test":
        return None  # a reference clip is the standard of others
    tests = [s for s in stimuli if s.role == "test" and s.scene == stimulus.scene]
    named = {s.reference for s in tests}
    return next((s for s in sorted(tests, key=lambda s: s.name) if s.name in named), None)


def mix(tests: list[Unit], catches: list[Unit], rng: random.Random) -> list[Unit]:
    """Puts each catch unit after a test unit, never first, no two together while gaps last."""
    gaps = list(range(1, len(tests) + 1)) or [0]
    rng.shuffle(gaps)
    ordered = list(tests)
    places = sorted((gaps[i % len(gaps)] for i in range(len(catches))), reverse=True)
    for place, unit in zip(places, catches, strict=True):
        ordered.insert(place, unit)
    return ordered


def separate(ordered: list[Unit], rng: random.Random) -> list[Unit]:
    """Reorders so that no scene follows itself, as far as the counts allow; the rest stays random.

    A unit is drawn from those of another scene than the last one; a scene with more units than all
    others together must be drawn now, or it could not be separated later.
    """
    left = list(ordered)
    result: list[Unit] = []
    while left:
        counts = Counter(unit.scene for unit in left)
        previous = result[-1].scene if result else None
        scene, num = counts.most_common(1)[0]
        allowed = [unit for unit in left if unit.scene != previous] or left
        if 2 * num > len(left) and scene != previous:
            allowed = [unit for unit in left if unit.scene == scene]
        # Never a catch first: people should meet an ordinary clip before a blatant one.
        if not result:
            allowed = [unit for unit in allowed if unit.kind != "catch"] or allowed
        chosen = rng.choice(allowed)
        left.remove(chosen)
        result.append(chosen)
    return result


def add_repeats(ordered: list[Unit], share: float, rng: random.Random) -> list[Unit]:
    """Shows a share of the test units again, in the last third, as far from the first as can be."""
    tests = [unit for unit in ordered if unit.kind == "test" and unit.clips]
    num = round(share * len(tests))
    early = tests[: max(num, 2 * len(tests) // 3)]
    repeats = [Unit(u.clips, "repeat", u.track, u.scene) for u in rng.sample(early, num)]
    result = list(ordered)
    last_third = 2 * len(result) // 3
    for unit in repeats:
        first = next(i for i, other in enumerate(result) if other.clips == unit.clips)
        result.insert(rng.randint(max(last_third, first + 2, 1), max(len(result), first + 2)), unit)
    return result


def count_scene_runs(ordered: Sequence[Unit]) -> int:
    """Returns how often a scene follows itself."""
    return sum(a.scene == b.scene for a, b in itertools.pairwise(ordered))
