# SPDX-License-Identifier: MIT
"""Sampler `random`: practice first, then each test clip once in random order, catch mixed in."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from verisim.study.server.samplers.sampler import PlannedTrial, Sampler
from verisim.study.server.stimulus_set import Stimulus
from verisim.study.server.yaml_source import Section


@dataclass(frozen=True)
class RandomOrder(Sampler):
    """A random order per participant; optionally never the same scene twice running."""

    name: ClassVar[str] = "random"

    separate_scenes: bool

    @classmethod
    def read(cls, section: Section) -> RandomOrder:
        return cls(
            seed=section.integer("seed", 0, 2**53 - 1),
            separate_scenes=section.choice("never_twice_running", ("scene",), None) is not None,
        )

    def plan(self, stimuli: Sequence[Stimulus], seed: str) -> list[PlannedTrial]:
        # The file's order must not matter, only its content: sort before shuffling.
        rng = random.Random(seed)
        by_role = {
            role: sorted((s for s in stimuli if s.role == role), key=lambda s: s.name)
            for role in ("practice", "test", "catch")
        }
        for clips in by_role.values():
            rng.shuffle(clips)
        main = mix(by_role["test"], by_role["catch"], rng)
        if self.separate_scenes:
            main = separate(main, rng)
        ordered = by_role["practice"] + main
        return [PlannedTrial(stimulus.role, stimulus.name) for stimulus in ordered]


def mix(tests: list[Stimulus], catches: list[Stimulus], rng: random.Random) -> list[Stimulus]:
    """Puts each catch clip after a test clip, never first, no two together while gaps last."""
    gaps = list(range(1, len(tests) + 1)) or [0]
    rng.shuffle(gaps)
    ordered = list(tests)
    places = sorted((gaps[i % len(gaps)] for i in range(len(catches))), reverse=True)
    for place, clip in zip(places, catches, strict=True):
        ordered.insert(place, clip)
    return ordered


def separate(ordered: list[Stimulus], rng: random.Random) -> list[Stimulus]:
    """Reorders so that no scene follows itself, as far as the counts allow; the rest stays random.

    A clip is drawn from those of another scene than the last one; a scene with more clips than all
    others together must be drawn now, or it could not be separated later.
    """
    left = list(ordered)
    result: list[Stimulus] = []
    while left:
        counts = Counter(clip.scene for clip in left)
        previous = result[-1].scene if result else None
        scene, num = counts.most_common(1)[0]
        allowed = [clip for clip in left if clip.scene != previous] or left
        if 2 * num > len(left) and scene != previous:
            allowed = [clip for clip in left if clip.scene == scene]
        # Never a catch clip first: people should meet an ordinary clip before a blatant one.
        if not result:
            allowed = [clip for clip in allowed if clip.role != "catch"] or allowed
        chosen = rng.choice(allowed)
        left.remove(chosen)
        result.append(chosen)
    return result
