# SPDX-License-Identifier: MIT
"""Sampler `blocks`: several samplers, one after the other, each on its own scenes."""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import ClassVar

from verisim.study.server.samplers.constant_stimuli import ConstantStimuli
from verisim.study.server.samplers.incomplete_block import BalancedIncompleteBlock
from verisim.study.server.samplers.random_order import Factorial, RandomOrder
from verisim.study.server.samplers.sampler import Pool, Sampler
from verisim.study.server.samplers.tracks import QuestTracks
from verisim.study.server.samplers.units import Unit
from verisim.study.server.samplers.williams import Williams
from verisim.study.server.yaml_source import Section

PARTS: dict[str, type[Sampler]] = {
    sampler.name: sampler
    for sampler in (
        RandomOrder,
        Factorial,
        ConstantStimuli,
        QuestTracks,
        BalancedIncompleteBlock,
        Williams,
    )
}


@dataclass(frozen=True)
class Part:
    """One block of the order."""

    name: str
    sampler: Sampler
    scenes: list[str] | None  # None: all

    def pool(self, pool: Pool) -> Pool:
        if self.scenes is None:
            return pool
        return Pool(
            [unit for unit in pool.tests if unit.scene in self.scenes],
            [s for s in pool.stimuli if s.scene in self.scenes],
            pool.pairs,
        )


@dataclass(frozen=True)
class Blocks(Sampler):
    """The blocks in the order of the file."""

    name: ClassVar[str] = "blocks"

    blocks: tuple[Part, ...]

    @classmethod
    def read(cls, section: Section) -> Blocks:
        items = section.take(
            "blocks", "a list of samplers", lambda v: isinstance(v, list) and len(v) > 0
        )
        parts: list[Part] = []
        for i, item in enumerate(items or []):
            inner = Section(section.source, item, (*section.at, "blocks", i))
            name = inner.choice("sampler", tuple(PARTS))
            if name is None:
                continue
            scenes = inner.take("scenes", "a list of scenes", _are_names, None)
            parts.append(Part(name, PARTS[name].read(inner), scenes))
            inner.finish()
        if sum(isinstance(part.sampler, QuestTracks) for part in parts) > 1:
            section.complain("blocks", "two blocks of tracks", "put all tracks into one block")
        return cls(tuple(parts))

    def parts(self, pool: Pool, list_no: int, rng: random.Random) -> list[tuple[list[Unit], bool]]:
        return [
            (part.sampler.choose(part.pool(pool), list_no, rng), part.sampler.keeps_order)
            for part in self.blocks
        ]

    def choose(self, pool: Pool, list_no: int, rng: random.Random) -> list[Unit]:
        return [unit for units, _ in self.parts(pool, list_no, rng) for unit in units]

    def find_problems(self, pool: Pool) -> list[str]:
        problems: list[str] = []
        for i, part in enumerate(self.blocks):
            own = part.pool(pool)
            if not own.tests:
                problems.append(f"block {i + 1} ({part.name}): no clip of {part.scenes}")
            else:
                faults = part.sampler.find_problems(own)
                problems += [f"block {i + 1} ({part.name}): {fault}" for fault in faults]
        return problems

    def describe(self, pool: Pool) -> list[str]:
        return [line for part in self.blocks for line in part.sampler.describe(part.pool(pool))]


def find_tracks(sampler: Sampler) -> QuestTracks | None:
    """Returns the adaptive tracks of a design, wherever they stand in it."""
    candidates = [p.sampler for p in sampler.blocks] if isinstance(sampler, Blocks) else [sampler]
    return next((s for s in candidates if isinstance(s, QuestTracks)), None)


def _are_names(value: object) -> bool:
    return isinstance(value, list) and len(value) > 0 and all(isinstance(v, str) for v in value)
