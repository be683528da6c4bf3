# SPDX-License-Identifier: MIT
"""Takes the words out of a free text that names somebody; that there was a text stays known."""

from __future__ import annotations

import json

from sqlalchemy import Connection, insert, select, update

from verisim.study.server import tables as t
from verisim.study.server.database import utc_now
from verisim.study.server.json_text import to_json

REDACTED = "[redacted]"


def redact_comment(connection: Connection, comment_id: int, *, reason: str, actor: str) -> bool:
    """Redacts a comment on a clip; False where there is none of this number."""
    row = connection.execute(
        select(t.comment.c.trial_id, t.comment.c.redacted, t.trial.c.participant_id)
        .join_from(t.comment, t.trial)
        .where(t.comment.c.comment_id == comment_id)
    ).first()
    if row is None or row.redacted:
        return False
    connection.execute(
        update(t.comment)
        .where(t.comment.c.comment_id == comment_id)
        .values(body=REDACTED, redacted=1)
    )
    _empty_log(connection, row.participant_id, "trials", row.trial_id)
    _audit(connection, "redact_comment", comment_id, reason, actor)
    return True


def redact_remark(connection: Connection, answer_id: int, *, reason: str, actor: str) -> bool:
    """Redacts a free text from the end of the session; False where there is none of this number."""
    row = connection.execute(
        select(t.session_answer.c.participant_id, t.session_answer.c.value_text)
        .join_from(t.session_answer, t.question)
        .where(t.session_answer.c.answer_id == answer_id, t.question.c.kind == "comment")
    ).first()
    if row is None or row.value_text == REDACTED:
        return False
    connection.execute(
        update(t.session_answer)
        .where(t.session_answer.c.answer_id == answer_id)
        .values(value_text=REDACTED)
    )
    _empty_log(connection, row.participant_id, "end_questions", None)
    _audit(connection, "redact_remark", answer_id, reason, actor)
    return True


def _empty_log(connection: Connection, participant_id: str, kind: str, trial: int | None) -> None:
    """Empties the logged bodies that held the words, those of repeated answers too."""
    log = t.submission.c
    sent = connection.execute(
        select(log.submission_id, log.body)
        .join_from(t.submission, t.session)
        .where(t.session.c.participant_id == participant_id, log.kind == kind, log.body != "")
    ).all()
    held = [s for s, body in sent if trial is None or json.loads(body)["trial_id"] == trial]
    connection.execute(update(t.submission).where(log.submission_id.in_(held)).values(body=""))


def _audit(connection: Connection, action: str, number: int, reason: str, actor: str) -> None:
    connection.execute(
        insert(t.admin_audit).values(
            at_utc=utc_now(),
            action=action,
            detail_json=to_json({"number": number, "reason": reason}),
            actor=actor,
        )
    )
