# SPDX-License-Identifier: MIT
"""Hands out cells and list numbers: quotas kept, abandoned lists given to the next participant."""

from __future__ import annotations

from collections import Counter
from datetime import UTC, datetime, timedelta
from typing import Any

from sqlalchemy import Connection, func, select

from verisim.study.server import tables
from verisim.study.server.api_error import ApiError
from verisim.study.server.database import insert_for
from verisim.study.server.open_study import OpenStudy

UNFINISHED = ("enrolled", "consented", "active")


def take_list(connection: Connection, opened: OpenStudy, now: str) -> tuple[str, int]:
    """Returns the emptiest cell below its quota and its lowest list that is free.

    A list is free again when its participant was erased, ended early, or has been away for
    `reclaim_after_min`. Raises ApiError 403 where every cell is full.
    """
    order = opened.study.order
    cells = order.cells(opened.stimulus_set.stimuli)
    quota = order.between.quota if order.between else None
    held = held_lists(connection, opened, now)
    counts = {cell: len(held[cell]) for cell in cells}
    free = [cell for cell in cells if quota is None or counts[cell] < quota]
    if not free:
        raise ApiError(
            403, "study_full", "enough people have taken part", "thank you for your interest"
        )
    cell = min(free, key=lambda name: (counts[name], cells.index(name)))
    list_no = next(i for i in range(len(held[cell]) + 1) if i not in held[cell])
    return cell, list_no


def held_lists(connection: Connection, opened: OpenStudy, now: str) -> dict[str, set[int]]:
    """Returns the lists of each cell that belong to somebody who finished or is at work."""
    slot, who, session = tables.list_slot.c, tables.participant.c, tables.session.c
    seen = (
        select(session.participant_id, func.max(session.last_seen_utc).label("seen"))
        .group_by(session.participant_id)
        .subquery()
    )
    rows = connection.execute(
        select(slot.cell, slot.list_no, who.state, seen.c.seen)
        .join_from(tables.list_slot, tables.participant)
        .outerjoin(seen, seen.c.participant_id == who.participant_id)
    )
    long_ago = earlier(now, opened.study.order.reclaim_after_min)
    held: dict[str, set[int]] = {cell: set() for cell in opened.study.order.cells(_clips(opened))}
    for row in rows:
        is_at_work = row.state in UNFINISHED and (row.seen or now) >= long_ago
        if row.state == "completed" or is_at_work:
            held.setdefault(row.cell, set()).add(row.list_no)
    return held


def reserve_list(
    connection: Connection,
    opened: OpenStudy,
    participant_id: str,
    cell: str,
    list_no: int,
    now: str,
) -> None:
    row = {
        "study_id": opened.study.name,
        "cell": cell,
        "list_no": list_no,
        "participant_id": participant_id,
        "reserved_utc": now,
    }
    keys = ["study_id", "cell", "list_no"]
    connection.execute(
        insert_for(connection, tables.list_slot)
        .values(row)
        .on_conflict_do_update(index_elements=keys, set_=row)
    )


def is_full(connection: Connection, opened: OpenStudy, now: str) -> bool:
    """True where no cell takes another participant."""
    order = opened.study.order
    if order.between is None or order.between.quota is None:
        return False
    held = held_lists(connection, opened, now)
    quota = order.between.quota
    return all(len(held[cell]) >= quota for cell in order.cells(_clips(opened)))


def count_states(connection: Connection) -> dict[str, Counter[str]]:
    """Returns, by cell, how many participants are in which state."""
    who = tables.participant.c
    counts: dict[str, Counter[str]] = {}
    for row in connection.execute(
        select(who.cell, who.state, func.count()).group_by(who.cell, who.state)
    ):
        counts.setdefault(row[0], Counter())[row[1]] = row[2]
    return counts


def earlier(now: str, minutes: int) -> str:
    """Returns the time so many minutes before, in the form of `utc_now`."""
    at = datetime.fromisoformat(now.replace("Z", "+00:00")) - timedelta(minutes=minutes)
    return at.astimezone(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")


def _clips(opened: OpenStudy) -> Any:
    return opened.stimulus_set.stimuli
