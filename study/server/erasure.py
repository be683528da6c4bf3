# SPDX-License-Identifier: MIT
"""The researcher's side of erasure: rows, deleted pages and the write-ahead log."""

from __future__ import annotations

from collections.abc import Callable

from sqlalchemy import Connection

from verisim.study.problems import refuse
from verisim.study.server.database import (
    Place,
    check_is_ours,
    checkpoint,
    lock_of,
    writing_engine,
)
from verisim.study.server.withdrawal import erase, find_participant, purge_outside_ids


def erase_participant(db: Place, participant: str, reason: str) -> int:
    """Deletes everything of one participant and returns the number of answers that went.

    participant: participant_id, completion code or outside id. Raises StudyError for an unknown
    participant and while a server uses the file (use its administration page then).
    """

    def work(connection: Connection) -> int:
        participant_id = find_participant(connection, participant)
        if participant_id is None:
            raise refuse(db, f"no participant {participant!r}", "check the code's spelling")
        return erase(connection, participant_id, reason=reason, actor="command line")

    return _alone(db, work)


def forget_outside_ids(db: Place) -> int:
    """Deletes every identifier of a recruiting platform and returns how many went."""
    return _alone(db, lambda connection: purge_outside_ids(connection, actor="command line"))


def _alone(db: Place, work: Callable[[Connection], int]) -> int:
    check_is_ours(db)
    with lock_of(db):
        engine = writing_engine(db)
        try:
            with engine.begin() as connection:
                num = work(connection)
        finally:
            engine.dispose()
        checkpoint(db)  # a deleted comment would otherwise stay readable in the log
    return num
