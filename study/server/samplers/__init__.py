# SPDX-License-Identifier: MIT
"""The registry of samplers, which decide who sees which clip when: add a file and name it here."""

from verisim.study.server.samplers.random_order import RandomOrder
from verisim.study.server.samplers.sampler import PlannedTrial, Sampler, participant_seed

SAMPLERS: dict[str, type[Sampler]] = {RandomOrder.name: RandomOrder}

__all__ = ["SAMPLERS", "PlannedTrial", "Sampler", "participant_seed"]
