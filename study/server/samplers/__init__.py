# SPDX-License-Identifier: MIT
"""Samplers decide who sees which clip when; the registry is in read_order.py."""

from verisim.study.server.samplers.blocks import find_tracks
from verisim.study.server.samplers.plan import Between, Order, PlannedTrial, order_json, plan_order
from verisim.study.server.samplers.read_order import SAMPLERS, read_order
from verisim.study.server.samplers.sampler import Pool, Sampler, participant_seed
from verisim.study.server.samplers.tracks import QuestTracks

__all__ = [
    "SAMPLERS",
    "Between",
    "Order",
    "PlannedTrial",
    "Pool",
    "QuestTracks",
    "Sampler",
    "find_tracks",
    "order_json",
    "participant_seed",
    "plan_order",
    "read_order",
]
