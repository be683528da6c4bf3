# SPDX-License-Identifier: MIT
"""What every sampler declares: its keys in the study file and which units a participant sees."""

from __future__ import annotations

import hashlib
import random
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from verisim.study.server.samplers.units import Unit
from verisim.study.server.stimulus_set import Stimulus
from verisim.study.server.yaml_source import Section


@dataclass(frozen=True)
class Pool:
    """What a participant's trials are drawn from: the clips of one cell, as units."""

    tests: list[Unit]
    stimuli: list[Stimulus]  # of the cell, every role
    pairs: str | None


@dataclass(frozen=True)
class Sampler(ABC):
    """Chooses and orders the test units; the same list number and seed give the same."""

    name: ClassVar[str]
    keeps_order: ClassVar[bool] = False  # the order is the design: nothing may move a unit

    @classmethod
    @abstractmethod
    def read(cls, section: Section) -> Sampler:
        """Takes this sampler's own keys from the study's `order`."""

    @abstractmethod
    def choose(self, pool: Pool, list_no: int, rng: random.Random) -> list[Unit]:
        """Returns the test units of the participant who was given list `list_no`."""

    def parts(self, pool: Pool, list_no: int, rng: random.Random) -> list[tuple[list[Unit], bool]]:
        """Returns the blocks of the order, and whether each must stay as it is."""
        return [(self.choose(pool, list_no, rng), self.keeps_order)]

    def find_problems(self, pool: Pool) -> list[str]:
        """Returns what makes this design impossible with these clips."""
        del pool
        return []

    def describe(self, pool: Pool) -> list[str]:
        """Returns lines for `verisim check`: what is special about this design."""
        del pool
        return []


def participant_seed(study_seed: int, list_no: int, cell: str = "") -> str:
    """Returns the seed of the participant who was given this list: 64 hexadecimal digits."""
    text = f"{study_seed}:{list_no}" + (f":{cell}" if cell else "")
    return hashlib.sha256(text.encode()).hexdigest()


def levels_of(stimuli: Sequence[Stimulus], factor: str) -> list[str]:
    """Returns the levels of a factor that occur among test clips, sorted."""
    levels = (s.factors.get(factor, "") for s in stimuli if s.role == "test")
    return sorted({level for level in levels if level})
