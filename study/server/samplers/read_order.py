# SPDX-License-Identifier: MIT
"""Reads `order` of a study file: the sampler's own keys and those that every sampler has."""

from __future__ import annotations

from verisim.study.server.samplers.blocks import PARTS, Blocks
from verisim.study.server.samplers.plan import Between, Order
from verisim.study.server.samplers.sampler import Sampler
from verisim.study.server.yaml_source import Section

SAMPLERS: dict[str, type[Sampler]] = {**PARTS, Blocks.name: Blocks}
RECLAIM_AFTER_MIN = 60


def read_order(section: Section) -> Order | None:
    """Takes `order`; None where not even the sampler is known."""
    name = section.choice("sampler", tuple(SAMPLERS))
    if name is None:
        return None
    order = Order(
        sampler=SAMPLERS[name].read(section),
        seed=section.integer("seed", 0, 2**53 - 1),
        separate_scenes=section.choice("never_twice_running", ("scene",), None) is not None,
        repeats=section.number("repeats", 0, 0.5, 0.0),
        pairs=_read_pairs(section),
        between=_read_between(section),
        reclaim_after_min=section.integer("reclaim_after_min", 5, 100_000, RECLAIM_AFTER_MIN),
    )
    if order.sampler.keeps_order and order.repeats:
        section.complain("repeats", f"cannot be mixed into the fixed order of {name}", "remove it")
    section.finish()
    return order


def _read_pairs(section: Section) -> str | None:
    if not section.has("pairs"):
        section.taken.append("pairs")
        return None
    pairs = section.section("pairs")
    against = pairs.choice("with", ("reference", "all"))
    pairs.finish()
    return against or "reference"


def _read_between(section: Section) -> Between | None:
    if not section.has("between"):
        section.taken.append("between")
        return None
    between = section.section("between")
    read = Between(
        factor=between.name("factor"), quota=between.integer("quota", 1, 1_000_000, None)
    )
    between.finish()
    return read
