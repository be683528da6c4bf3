# SPDX-License-Identifier: MIT
"""A participant arrives: random names, a token, and an order that is planned and stored at once."""

from __future__ import annotations

import hashlib
import hmac
import secrets
from typing import Any

from sqlalchemy import Connection, func, insert, select, update

from verisim.study.server import tables
from verisim.study.server.api_error import ApiError
from verisim.study.server.bodies import SessionBody
from verisim.study.server.database import utc_now
from verisim.study.server.open_study import OpenStudy, to_json
from verisim.study.server.reply import Reply
from verisim.study.server.samplers import PlannedTrial, participant_seed
from verisim.study.server.submissions import record_submission

CODE_LETTERS = "ABCDEFGHJKLMNPQRSTUVWXYZ23456789"  # none that is mistaken for another


def hash_token(token: str) -> str:
    return hashlib.sha256(token.encode()).hexdigest()


def choose_source(body: SessionBody, source_default: str, simulate_key: str | None) -> str:
    """Returns the participant's source; the key makes simulated, and nothing else does."""
    source = body.source or source_default
    if source == "simulated" or body.simulate_key is not None:
        given = (body.simulate_key or "").encode(errors="surrogatepass")
        known = simulate_key is not None and hmac.compare_digest(given, simulate_key.encode())
        if not known or source != "simulated":
            raise ApiError(
                403,
                "not_simulated",
                "source `simulated` and simulate_key go together, and the key must be the server's",
                "leave simulate_key out to take part yourself",
            )
    return source


def enrol(connection: Connection, opened: OpenStudy, body: SessionBody, source: str) -> Reply:
    """Creates participant, order and session; the token is in the reply and nowhere else."""
    known = select(tables.submission.c.submission_id).where(
        tables.submission.c.submission_id == body.submission_id
    )
    if connection.execute(known).first() is not None:
        raise ApiError(
            409,
            "duplicate_session",
            "this submission_id has already opened a session; its token is not kept",
            "open a new session with a new submission_id",
        )
    now = utc_now()
    participant_id, session_id = f"p{secrets.token_hex(12)}", f"s{secrets.token_hex(12)}"
    token = secrets.token_urlsafe(32)
    connection.execute(
        insert(tables.participant).values(
            participant_id=participant_id,
            study_id=opened.study.name,
            source=source,
            state="enrolled",
            completion_code=_completion_code(),
            enrolled_utc=now,
        )
    )
    _assign_order(connection, opened, participant_id, now)
    env = body.environment
    connection.execute(
        insert(tables.session).values(
            session_id=session_id,
            participant_id=participant_id,
            token_sha256=hash_token(token),
            started_utc=now,
            last_seen_utc=now,
            app_version=env.app_version,
            browser=env.browser,
            browser_version=env.browser_version,
            os=env.os,
            is_mobile=int(env.is_mobile),
            screen_w_px=env.screen_w,
            screen_h_px=env.screen_h,
            viewport_w_px=env.viewport_w,
            viewport_h_px=env.viewport_h,
            device_pixel_ratio=env.device_pixel_ratio,
            refresh_hz=env.refresh_hz,
            language=env.language,
            tz_offset_min=env.tz_offset_min,
        )
    )
    # The key that marks simulated raters is a secret of the server: it stays out of the log.
    logged = body.model_copy(update={"simulate_key": None}).model_dump_json().encode()
    record_submission(connection, session_id, body.submission_id, "session", logged, "stored", now)
    reply = {"token": token, "participant_id": participant_id, "session_id": session_id}
    return Reply(201, reply)


def _completion_code() -> str:
    letters = "".join(secrets.choice(CODE_LETTERS) for _ in range(10))
    return f"{letters[:5]}-{letters[5:]}"


def _assign_order(connection: Connection, opened: OpenStudy, participant_id: str, now: str) -> None:
    sampler = opened.study.order
    list_no = _take_list(connection, opened.study.name, participant_id, now)
    seed = participant_seed(sampler.seed, list_no)
    plan = sampler.plan(opened.stimulus_set.stimuli, seed)
    connection.execute(
        insert(tables.assignment).values(
            participant_id=participant_id,
            algorithm=sampler.name,
            list_no=list_no,
            seed=seed,
            order_sha256=order_sha256(plan),
        )
    )
    connection.execute(insert(tables.trial), _trial_rows(opened, participant_id, plan))


def order_sha256(plan: list[PlannedTrial]) -> str:
    """Returns the hash that shows later that an order is the one its seed gives."""
    lines = "".join(f"{trial.trial_kind}\t{trial.stimulus}\n" for trial in plan)
    return hashlib.sha256(lines.encode()).hexdigest()


def _take_list(connection: Connection, study_id: str, participant_id: str, now: str) -> int:
    """Takes the lowest list that is free again, else the next number."""
    slot = tables.list_slot
    free = select(func.min(slot.c.list_no)).where(slot.c.participant_id.is_(None))
    list_no = connection.scalar(free)
    if list_no is not None:
        connection.execute(
            update(slot)
            .where(slot.c.list_no == list_no)
            .values(participant_id=participant_id, reserved_utc=now)
        )
        return int(list_no)
    last = connection.scalar(select(func.max(slot.c.list_no)))
    list_no = 0 if last is None else int(last) + 1
    connection.execute(
        insert(slot).values(
            study_id=study_id, list_no=list_no, participant_id=participant_id, reserved_utc=now
        )
    )
    return list_no


def _trial_rows(
    opened: OpenStudy, participant_id: str, plan: list[PlannedTrial]
) -> list[dict[str, Any]]:
    """Numbers the trials; block 0 is practice, then a new block begins after each rest."""
    study = opened.study
    primary = study.question(study.analysis.primary).scale()
    assert primary is not None  # the study file allows only a numeric primary question
    middle = (primary.min + primary.max) / 2
    expected = to_json({"question": study.analysis.primary, "below": middle})
    num_practice = sum(trial.trial_kind == "practice" for trial in plan)
    rows = []
    for i, trial in enumerate(plan):
        is_practice = trial.trial_kind == "practice"
        rest_every = study.trial.rest_every or len(plan)
        rows.append(
            {
                "participant_id": participant_id,
                "trial_index": i,
                "block": 0 if is_practice else 1 + (i - num_practice) // rest_every,
                "trial_kind": trial.trial_kind,
                "layout": study.trial.layout,
                "stimulus_a": opened.stimulus_ids[trial.stimulus],
                "expected_json": expected if trial.trial_kind == "catch" else None,
            }
        )
    return rows
