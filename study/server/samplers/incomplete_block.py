# SPDX-License-Identifier: MIT
"""Sampler `balanced_incomplete_block`: everybody sees some units, every two equally often."""

from __future__ import annotations

import itertools
import math
import random
from collections import Counter
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

from verisim.study.server.samplers.sampler import Pool, Sampler
from verisim.study.server.samplers.units import Unit
from verisim.study.server.yaml_source import Section

MAX_BLOCKS = 2000  # of the design that takes every subset
MAX_BASES = 4
MAX_TRIES = 20_000  # base blocks that one search for a small design looks at
Block = tuple[int, ...]


@lru_cache(maxsize=64)
def find_blocks(num: int, size: int) -> tuple[Block, ...]:
    """Returns blocks in which every item, and every pair of items, occurs equally often.

    Looks for difference families (R. C. Bose 1939, Ann. Eugenics 9, p. 353): base blocks whose
    differences cover the residues modulo `num` evenly, or modulo num - 1 with one fixed point.
    Falls back to all subsets. Raises ValueError where even those are too many.
    """
    if not 2 <= size <= num:
        raise ValueError(f"a block of {size} out of {num} is no incomplete block")
    if size == num:
        return (tuple(range(num)),)
    for num_bases in range(1, MAX_BASES + 1):
        found = _cyclic(num, size, num_bases) or _one_rotational(num, size, num_bases)
        if found and len(found) < math.comb(num, size):
            return tuple(found)
    if math.comb(num, size) > MAX_BLOCKS:
        raise ValueError(f"no balanced design of {num} units in blocks of {size} was found")
    return tuple(itertools.combinations(range(num), size))


def _cyclic(num: int, size: int, num_bases: int) -> list[Block]:
    """Develops base blocks modulo num; every difference must occur lambda times."""
    total = num_bases * size * (size - 1)
    if total % (num - 1):
        return []
    target = total // (num - 1)
    candidates = [(0, *rest) for rest in _some_subsets(range(1, num), size - 1)]
    bases = _search(candidates, num, num_bases, dict.fromkeys(range(1, num), target))
    return [tuple(sorted((x + s) % num for x in b)) for b in bases for s in range(num)]


def _one_rotational(num: int, size: int, num_bases: int) -> list[Block]:
    """The same modulo num - 1 with a point that stays; bases with it give that point its pairs."""
    modulus = num - 1
    for with_point in range(1, num_bases):
        without = num_bases - with_point
        pairs = with_point * (size - 1) * (size - 2) + without * size * (size - 1)
        # The fixed point meets each other one `with_point` * (size-1) times over the shifts.
        target = with_point * (size - 1)
        if modulus < 2 or pairs != target * (modulus - 1):
            continue
        left = dict.fromkeys(range(1, modulus), target)
        fixed = [(0, *rest) for rest in _some_subsets(range(1, modulus), size - 2)]
        plain = [(0, *rest) for rest in _some_subsets(range(1, modulus), size - 1)]
        for chosen in _search_all(fixed, modulus, with_point, left, 10):
            rest_left = _less(left, chosen, modulus)
            if rest_left is None:
                continue
            if bases := _search(plain, modulus, without, rest_left):
                blocks = [_shift(b, s, modulus) for b in bases for s in range(modulus)]
                blocks += [
                    (*_shift(b, s, modulus), modulus) for b in chosen for s in range(modulus)
                ]
                return blocks
    return []


def _shift(block: Block, shift: int, modulus: int) -> Block:
    return tuple(sorted((x + shift) % modulus for x in block))


def _some_subsets(values: range, size: int) -> list[Block]:
    if math.comb(len(values), size) > MAX_TRIES // 4:
        return []
    return list(itertools.combinations(values, size))


def _differences(block: Block, modulus: int) -> Counter[int]:
    return Counter((a - b) % modulus for a, b in itertools.permutations(block, 2))


def _less(left: dict[int, int], blocks: list[Block], modulus: int) -> dict[int, int] | None:
    rest = dict(left)
    for block in blocks:
        for difference, num in _differences(block, modulus).items():
            rest[difference] -= num
    return None if any(num < 0 for num in rest.values()) else rest


def _search(
    candidates: list[Block], modulus: int, num_bases: int, left: dict[int, int]
) -> list[Block]:
    """Returns base blocks whose differences are exactly `left`, [] if the search finds none."""
    for chosen in _search_all(candidates, modulus, num_bases, left, 1, exact=True):
        return chosen
    return []


def _search_all(
    candidates: list[Block],
    modulus: int,
    num_bases: int,
    left: dict[int, int],
    limit: int,
    *,
    exact: bool = False,
) -> list[list[Block]]:
    found: list[list[Block]] = []
    tries = 0
    differences = [_differences(block, modulus) for block in candidates]

    def descend(start: int, chosen: list[Block], rest: dict[int, int]) -> None:
        nonlocal tries
        if len(chosen) == num_bases:
            if not exact or not any(rest.values()):
                found.append(list(chosen))
            return
        for i in range(start, len(candidates)):
            tries += 1
            if len(found) >= limit or tries > MAX_TRIES:
                return
            if all(rest[d] >= num for d, num in differences[i].items()):
                after = dict(rest)
                for d, num in differences[i].items():
                    after[d] -= num
                descend(i, [*chosen, candidates[i]], after)

    descend(0, [], left)
    return found


@dataclass(frozen=True)
class BalancedIncompleteBlock(Sampler):
    """List number i sees block i of the design, `times` times each, in random order."""

    name: ClassVar[str] = "balanced_incomplete_block"

    block_size: int
    times: int

    @classmethod
    def read(cls, section: Section) -> BalancedIncompleteBlock:
        return cls(
            block_size=section.integer("block_size", 2, 500),
            times=section.integer("times", 1, 100, 1),
        )

    def choose(self, pool: Pool, list_no: int, rng: random.Random) -> list[Unit]:
        blocks = find_blocks(len(pool.tests), self.block_size)
        block = blocks[list_no % len(blocks)]
        rounds = [rng.sample(block, len(block)) for _ in range(self.times)]
        return [pool.tests[i] for i in itertools.chain.from_iterable(rounds)]

    def find_problems(self, pool: Pool) -> list[str]:
        try:
            find_blocks(len(pool.tests), self.block_size)
        except ValueError as error:
            return [f"{error}; change `block_size` or the number of clips"]
        return []

    def describe(self, pool: Pool) -> list[str]:
        num, blocks = len(pool.tests), find_blocks(len(pool.tests), self.block_size)
        each = len(blocks) * self.block_size // num
        together = each * (self.block_size - 1) // (num - 1)
        return [
            f"balanced incomplete blocks: {num} units in {len(blocks)} blocks of "
            f"{self.block_size}; each unit in {each}, each two together in {together}; complete "
            f"after {len(blocks)} participants"
        ]
