# SPDX-License-Identifier: MIT
"""Takes a participant's data back: by token, by the link of the debrief page, by the researcher."""

from __future__ import annotations

import hashlib
import hmac
from typing import Any

from sqlalchemy import Connection, delete, func, insert, or_, select

from verisim.study.server import tables
from verisim.study.server.api_error import ApiError
from verisim.study.server.database import utc_now
from verisim.study.server.json_text import to_json
from verisim.study.server.reply import Reply
from verisim.study.server.submissions import Caller

ERASED = Reply(200, {"erased": True})


def withdrawal_of(connection: Connection, participant_id: str) -> str:
    """Returns the secret that erases a participant; made from a key, so it is stored nowhere."""
    key = connection.scalar(select(tables.study.c.withdraw_key)) or ""
    seal = hmac.new(bytes.fromhex(key), participant_id.encode(), hashlib.sha256).hexdigest()
    return f"{participant_id}.{seal}"


def withdraw(connection: Connection, caller: Caller) -> Reply:
    erase(connection, caller.participant_id, reason="participant", actor="participant")
    return ERASED


def withdraw_by_link(connection: Connection, withdrawal: str) -> Reply:
    """Erases whom the link belongs to. Raises ApiError 404 for any other, also after erasure."""
    participant_id = withdrawal.partition(".")[0]
    who = tables.participant.c
    known = connection.scalar(
        select(who.participant_id).where(who.participant_id == participant_id)
    )
    expected = withdrawal_of(connection, participant_id)
    if known is None or not hmac.compare_digest(expected.encode(), withdrawal.encode()):
        raise ApiError(
            404,
            "withdrawal_unknown",
            "there is nothing to delete under this link",
            "it may have been deleted already; else ask the person in charge",
        )
    erase(connection, participant_id, reason="participant, by link", actor="participant")
    return ERASED


def find_participant(connection: Connection, named: str) -> str | None:
    """Returns the participant_id of a participant_id, completion code or outside id."""
    who, link = tables.participant.c, tables.participant_link.c
    found: Any = connection.scalar(
        select(who.participant_id)
        .outerjoin_from(tables.participant, tables.participant_link)
        .where(
            or_(
                who.participant_id == named,
                who.completion_code == named,
                link.external_id == named,
            )
        )
    )
    return None if found is None else str(found)


def erase(connection: Connection, participant_id: str, *, reason: str, actor: str) -> int:
    """Deletes everything of one participant and returns the number of answers that went.

    The outside id goes first. What stays is a note that somebody was erased, without whom.
    """
    who = tables.participant.c
    study_id = connection.scalar(select(who.study_id).where(who.participant_id == participant_id))
    trials = select(tables.trial.c.trial_id).where(tables.trial.c.participant_id == participant_id)
    num_answers = sum(
        connection.scalar(
            select(func.count()).select_from(table).where(table.c.trial_id.in_(trials))
        )
        or 0
        for table in (tables.response, tables.comment)
    )
    num_answers += (
        connection.scalar(
            select(func.count())
            .select_from(tables.session_answer)
            .where(tables.session_answer.c.participant_id == participant_id)
        )
        or 0
    )
    link = tables.participant_link
    connection.execute(delete(link).where(link.c.participant_id == participant_id))
    connection.execute(delete(tables.participant).where(who.participant_id == participant_id))
    now = utc_now()
    note = {"study_id": study_id, "num_rows": num_answers, "reason": reason}
    connection.execute(insert(tables.erasure).values(erased_utc=now, **note))
    connection.execute(
        insert(tables.admin_audit).values(
            at_utc=now, action="erase_participant", detail_json=to_json(note), actor=actor
        )
    )
    return int(num_answers)


def purge_outside_ids(connection: Connection, *, actor: str) -> int:
    """Empties the table of outside ids, e.g. after everybody was paid; returns how many went."""
    num = connection.scalar(select(func.count()).select_from(tables.participant_link)) or 0
    connection.execute(delete(tables.participant_link))
    connection.execute(
        insert(tables.admin_audit).values(
            at_utc=utc_now(),
            action="purge_outside_ids",
            detail_json=to_json({"num_rows": num}),
            actor=actor,
        )
    )
    return int(num)
