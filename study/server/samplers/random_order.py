# SPDX-License-Identifier: MIT
"""Samplers that show everything: `random` once each, `factorial` every cell of a full crossing."""

from __future__ import annotations

import itertools
import random
from collections import Counter
from dataclasses import dataclass
from typing import ClassVar

from verisim.study.server.samplers.sampler import Pool, Sampler, levels_of
from verisim.study.server.samplers.units import Unit
from verisim.study.server.yaml_source import Section


@dataclass(frozen=True)
class RandomOrder(Sampler):
    """Each test unit once, in random order."""

    name: ClassVar[str] = "random"

    @classmethod
    def read(cls, section: Section) -> RandomOrder:
        del section
        return cls()

    def choose(self, pool: Pool, list_no: int, rng: random.Random) -> list[Unit]:
        del list_no
        return rng.sample(pool.tests, len(pool.tests))


@dataclass(frozen=True)
class Factorial(Sampler):
    """Each test unit `times` times, one round after another; every cell must have a clip."""

    name: ClassVar[str] = "factorial"

    times: int

    @classmethod
    def read(cls, section: Section) -> Factorial:
        return cls(times=section.integer("times", 1, 100, 1))

    def choose(self, pool: Pool, list_no: int, rng: random.Random) -> list[Unit]:
        del list_no
        rounds = [rng.sample(pool.tests, len(pool.tests)) for _ in range(self.times)]
        return list(itertools.chain.from_iterable(rounds))

    def find_problems(self, pool: Pool) -> list[str]:
        """A cell of scene × factors × seed without a clip, or with several."""
        problems: list[str] = []
        tests = [s for s in pool.stimuli if s.role == "test"]
        for scene in dict.fromkeys(s.scene for s in tests):
            own = [s for s in tests if s.scene == scene]
            factors = [f for f in own[0].factors if any(s.factors[f] for s in own)]
            seeds = list(dict.fromkeys(s.seed for s in own))
            have = Counter((*(s.factors[f] for f in factors), s.seed) for s in own)
            levels = [levels_of(own, factor) for factor in factors]
            for cell in itertools.product(*levels, seeds):
                if have[cell] != 1:
                    named = dict(zip([*factors, "seed"], cell, strict=True))
                    problems.append(f"{scene}: {have[cell]} clips at {named}; needed: 1")
        return problems
