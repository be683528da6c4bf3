# SPDX-License-Identifier: MIT
"""Sampler `constant_stimuli`: fixed levels of one factor, each shown many times."""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import ClassVar

from verisim.study.server.samplers.sampler import Pool, Sampler, levels_of
from verisim.study.server.samplers.units import Unit
from verisim.study.server.yaml_source import Section


@dataclass(frozen=True)
class ConstantStimuli(Sampler):
    """`times` presentations of each level of `factor`; clips of a level take turns."""

    name: ClassVar[str] = "constant_stimuli"

    factor: str
    times: int

    @classmethod
    def read(cls, section: Section) -> ConstantStimuli:
        return cls(factor=section.name("factor"), times=section.integer("times", 1, 500))

    def choose(self, pool: Pool, list_no: int, rng: random.Random) -> list[Unit]:
        del list_no
        by_level: dict[str, list[Unit]] = {}
        for unit in pool.tests:
            if level := unit.clips[0].factors.get(self.factor, ""):
                by_level.setdefault(level, []).append(unit)
        turns = [self._turns(units, rng) for units in by_level.values()]
        rounds: list[Unit] = []
        for i in range(self.times):  # each round holds every level once, so levels spread evenly
            rounds.extend(rng.sample([units[i] for units in turns], len(turns)))
        return rounds

    def _turns(self, units: list[Unit], rng: random.Random) -> list[Unit]:
        turns: list[Unit] = []
        while len(turns) < self.times:
            turns.extend(rng.sample(units, len(units)))
        return turns[: self.times]

    def find_problems(self, pool: Pool) -> list[str]:
        levels = levels_of(pool.stimuli, self.factor)
        if len(levels) >= 2:
            return []
        return [f"factor {self.factor!r} has {len(levels)} levels among the clips; needed: 2"]
