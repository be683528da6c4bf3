# SPDX-License-Identifier: MIT
"""Erases a participant for good: rows, deleted pages and the write-ahead log."""

from __future__ import annotations

from pathlib import Path

from sqlalchemy import delete, func, insert, or_, select

from verisim.study.problems import refuse
from verisim.study.server import tables
from verisim.study.server.database import (
    DatabaseLock,
    check_is_ours,
    checkpoint,
    utc_now,
    writing_engine,
)
from verisim.study.server.open_study import to_json


def erase_participant(db: Path, participant: str, reason: str) -> int:
    """Deletes everything of one participant and returns the number of answers that went.

    participant: participant_id or completion code. What stays is a note that somebody was erased,
    without whom. Raises StudyError for an unknown participant and while a server uses the file.
    """
    check_is_ours(db)
    who = tables.participant.c
    with DatabaseLock(db):
        engine = writing_engine(db)
        try:
            with engine.begin() as connection:
                row = connection.execute(
                    select(who.participant_id, who.study_id).where(
                        or_(who.participant_id == participant, who.completion_code == participant)
                    )
                ).first()
                if row is None:
                    raise refuse(db, f"no participant {participant!r}", "check the code's spelling")
                trials = select(tables.trial.c.trial_id).where(
                    tables.trial.c.participant_id == row.participant_id
                )
                num_answers = sum(
                    connection.scalar(
                        select(func.count()).select_from(table).where(table.c.trial_id.in_(trials))
                    )
                    or 0
                    for table in (tables.response, tables.comment)
                )
                connection.execute(
                    delete(tables.participant).where(who.participant_id == row.participant_id)
                )
                now = utc_now()
                note = {"study_id": row.study_id, "num_rows": num_answers, "reason": reason}
                connection.execute(insert(tables.erasure).values(erased_utc=now, **note))
                connection.execute(
                    insert(tables.admin_audit).values(
                        at_utc=now, action="erase_participant", detail_json=to_json(note)
                    )
                )
        finally:
            engine.dispose()
        checkpoint(db)  # a deleted comment would otherwise stay readable in the log
    return num_answers
