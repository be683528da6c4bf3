# SPDX-License-Identifier: MIT
"""The raw log of accepted POSTs, which makes a repeated one harmless, and who sent it."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

from sqlalchemy import Connection, bindparam, insert, select, update

from verisim.study.server import tables
from verisim.study.server.api_error import ApiError
from verisim.study.server.database import utc_now
from verisim.study.server.reply import DUPLICATE, STORED, Reply


@dataclass(frozen=True)
class Caller:
    """The session that a token belongs to."""

    session_id: str
    participant_id: str
    state: str  # of the participant
    completion_code: str
    buttons: str  # normal | reversed order of options
    seed: str  # of the participant's order
    language: str | None  # of the consent given


@dataclass(frozen=True)
class Post:
    """An accepted body on its way into the log."""

    submission_id: str
    kind: str
    raw: bytes


# Built once: every request needs them, and building takes longer than running.
_CALLER = (
    select(
        tables.session.c.session_id,
        tables.session.c.participant_id,
        tables.participant.c.state,
        tables.participant.c.completion_code,
        tables.participant.c.buttons,
        tables.assignment.c.seed,
        tables.consent.c.language,
    )
    .select_from(tables.session)
    .join(tables.participant)
    .join(tables.assignment, tables.assignment.c.participant_id == tables.session.c.participant_id)
    .outerjoin(tables.consent, tables.consent.c.participant_id == tables.session.c.participant_id)
    .where(tables.session.c.token_sha256 == bindparam("token"))
)


_EARLIER = select(
    tables.submission.c.session_id,
    tables.submission.c.kind,
    tables.submission.c.outcome,
    tables.submission.c.body_sha256,
).where(tables.submission.c.submission_id == bindparam("sent"))
_SEEN_NOW = (
    update(tables.session)
    .where(tables.session.c.session_id == bindparam("own"))
    .values(last_seen_utc=bindparam("now"))
)
_LOG = insert(tables.submission)


def find_caller(connection: Connection, token_sha256: str) -> Caller:
    """Returns whose token this is. Raises ApiError 401 for an unknown one."""
    row = connection.execute(_CALLER, {"token": token_sha256}).first()
    if row is None:
        raise ApiError(401, "bad_token", "this token is not known", "open a new session")
    return Caller(*row)


def answer_of_earlier(connection: Connection, caller: Caller, post: Post) -> Reply | None:
    """Returns the reply to a submission that has been accepted before, None for a new one."""
    row = connection.execute(_EARLIER, {"sent": post.submission_id}).first()
    if row is None:
        return None
    if row.session_id != caller.session_id:
        raise ApiError(409, "submission_id_taken", "this submission_id is in use", "use a new one")
    if row.kind != post.kind or row.body_sha256 != sha256(post.raw):
        raise ApiError(
            409,
            "submission_id_reused",
            "another body was sent under this submission_id",
            "use a new submission_id for each new body",
        )
    return DUPLICATE if row.outcome == "stored" else already_answered()


def accept(connection: Connection, caller: Caller, post: Post, outcome: str = "stored") -> Reply:
    """Logs a body and that its sender was here."""
    now = utc_now()
    record_submission(
        connection, caller.session_id, post.submission_id, post.kind, post.raw, outcome, now
    )
    connection.execute(_SEEN_NOW, {"own": caller.session_id, "now": now})
    return STORED if outcome == "stored" else already_answered()


def record_submission(
    connection: Connection,
    session_id: str,
    submission_id: str,
    kind: str,
    raw: bytes,
    outcome: str,
    now: str,
) -> None:
    row = {
        "submission_id": submission_id,
        "session_id": session_id,
        "kind": kind,
        "outcome": outcome,
        "body": raw.decode(),
        "body_sha256": sha256(raw),
        "received_utc": now,
    }
    connection.execute(_LOG, row)


def already_answered() -> Reply:
    """The first answer stands; the later body is in the log, so this is a reply, not a rollback."""
    error = ApiError(
        409,
        "already_answered",
        "this was answered before; the first answer stands",
        "go on with GET /api/next",
    )
    return Reply(error.status, error.body())


def sha256(raw: bytes) -> str:
    return hashlib.sha256(raw).hexdigest()
