# SPDX-License-Identifier: MIT
"""Sampler `williams`: each condition follows each other one equally often, over participants."""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import ClassVar

from verisim.study.server.samplers.sampler import Pool, Sampler, levels_of
from verisim.study.server.samplers.units import Unit
from verisim.study.server.yaml_source import Section


def williams_rows(num: int) -> list[list[int]]:
    """Returns a row-complete Latin square for an even number, a pair of squares for an odd one.

    Every condition stands equally often at every place and follows each other condition equally
    often. Source: E. J. Williams 1949, Aust. J. Sci. Res. A 2, p. 149: first row 0, n-1, 1, n-2 …
    (here 0, 1, n-1, 2, …), the others by adding 1 modulo n; odd n adds each row reversed.
    """
    first, low, high = [0], 1, num - 1
    while len(first) < num:
        first.append(low)
        low += 1
        if len(first) < num:
            first.append(high)
            high -= 1
    rows = [[(value + shift) % num for value in first] for shift in range(num)]
    return rows if num % 2 == 0 else rows + [row[::-1] for row in rows]


@dataclass(frozen=True)
class Williams(Sampler):
    """Conditions are the levels of `factor`; which scene shows a level is random."""

    name: ClassVar[str] = "williams"
    keeps_order: ClassVar[bool] = True

    factor: str

    @classmethod
    def read(cls, section: Section) -> Williams:
        return cls(factor=section.name("factor"))

    def choose(self, pool: Pool, list_no: int, rng: random.Random) -> list[Unit]:
        by_level = self._by_level(pool)
        rows = williams_rows(len(by_level))
        row = rows[list_no % len(rows)]
        shuffled = [rng.sample(units, len(units)) for units in by_level]
        num_rounds = min(len(units) for units in by_level)
        return [shuffled[condition][i] for i in range(num_rounds) for condition in row]

    def _by_level(self, pool: Pool) -> list[list[Unit]]:
        levels = levels_of(pool.stimuli, self.factor)
        return [
            [u for u in pool.tests if u.clips[0].factors[self.factor] == level] for level in levels
        ]

    def find_problems(self, pool: Pool) -> list[str]:
        by_level = [units for units in self._by_level(pool) if units]
        if len(by_level) < 2:
            return [f"factor {self.factor!r} has {len(by_level)} levels to show; needed: 2"]
        counts = {len(units) for units in by_level}
        if len(counts) > 1:
            return [f"the levels of {self.factor!r} have {sorted(counts)} clips; needed: as many"]
        return []

    def describe(self, pool: Pool) -> list[str]:
        rows = williams_rows(len(self._by_level(pool)))
        return [f"Williams design: {len(rows)} orders; complete after {len(rows)} participants"]
