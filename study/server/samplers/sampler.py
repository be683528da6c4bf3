# SPDX-License-Identifier: MIT
"""What every sampler declares: its keys in the study file and the order it makes from a seed."""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from verisim.study.server.stimulus_set import Stimulus
from verisim.study.server.yaml_source import Section


@dataclass(frozen=True)
class PlannedTrial:
    """One trial of a participant's order, before it gets its number."""

    trial_kind: str  # practice | test | catch
    stimulus: str


@dataclass(frozen=True)
class Sampler(ABC):
    """Makes a participant's order; the same seed makes the same order."""

    name: ClassVar[str]

    seed: int

    @classmethod
    @abstractmethod
    def read(cls, section: Section) -> Sampler:
        """Takes this sampler's keys from the study's `order`."""

    @abstractmethod
    def plan(self, stimuli: Sequence[Stimulus], seed: str) -> list[PlannedTrial]:
        """Returns the participant's trials in order; seed: as stored with the participant."""


def participant_seed(study_seed: int, list_no: int) -> str:
    """Returns the seed of the participant who was given list `list_no`: 64 hexadecimal digits."""
    return hashlib.sha256(f"{study_seed}:{list_no}".encode()).hexdigest()
