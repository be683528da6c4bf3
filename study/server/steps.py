# SPDX-License-Identifier: MIT
"""Stores the steps around the trials: consent, screen, instructions, last questions, stopping."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

from sqlalchemy import Connection, func, insert, select, update

from verisim.study.server import tables
from verisim.study.server.api_error import ApiError
from verisim.study.server.asked import check_answers
from verisim.study.server.bodies import (
    ConsentBody,
    EndBody,
    InstructionsBody,
    ScreenBody,
    StopBody,
)
from verisim.study.server.database import utc_now
from verisim.study.server.json_text import to_json
from verisim.study.server.open_study import OpenStudy
from verisim.study.server.reply import Reply
from verisim.study.server.screen_check import check_screen
from verisim.study.server.submissions import Caller, Post, accept, answer_of_earlier


def store_consent(
    connection: Connection, opened: OpenStudy, caller: Caller, post: Post, body: ConsentBody
) -> Reply:
    """Stores agreement or refusal, with the form that was shown."""
    if earlier := answer_of_earlier(connection, caller, post):
        return earlier
    if caller.state != "enrolled":
        return accept(connection, caller, post, "already_answered")
    form = opened.study.consent.get(body.language)
    if form is None or (form.version, form.sha256) != (body.form_version, body.form_sha256):
        raise ApiError(
            422,
            "other_form",
            "this is not the consent form that the server shows",
            "load the page again and read the form anew",
        )
    now = utc_now()
    connection.execute(
        insert(tables.consent).values(
            participant_id=caller.participant_id,
            form_version=form.version,
            form_sha256=form.sha256,
            language=body.language,
            agreed=int(body.agreed),
            answered_utc=now,
        )
    )
    set_state(connection, caller, "consented" if body.agreed else "declined")
    if not body.agreed:
        end_session(connection, caller, now)
    return accept(connection, caller, post)


def store_screen(
    connection: Connection, opened: OpenStudy, caller: Caller, post: Post, body: ScreenBody
) -> Reply:
    """Stores a check of the screen; a fault that cannot be mended ends the session."""
    if earlier := answer_of_earlier(connection, caller, post):
        return with_verdict(connection, caller, earlier)
    rules = opened.study.screen
    if (
        caller.state != "consented"
        or rules is None
        or last_verdict(connection, caller)
        in (
            "passed",
            "flagged",
        )
    ):
        return accept(connection, caller, post, "already_answered")
    across = 2 if "side_by_side" in opened.study.trial.layouts else 1
    result = check_screen(rules, opened.stimulus_set.stimuli, across, body)
    now = utc_now()
    env = body.environment
    measured = {
        "refresh_hz": body.refresh_hz,
        "css_px_per_mm": body.css_px_per_mm,
        "viewing_distance_mm": body.viewing_distance_mm,
        "px_per_degree": result.px_per_degree,
        "viewport_w_px": env.viewport_w,
        "viewport_h_px": env.viewport_h,
    }
    connection.execute(
        insert(tables.screen_check).values(
            session_id=caller.session_id,
            verdict=result.verdict,
            problems_json=to_json(result.problems),
            codec_plays=None if body.codec_plays is None else int(body.codec_plays),
            fullscreen=int(body.fullscreen),
            calibration_skipped=int(body.calibration_skipped),
            checked_utc=now,
            **measured,
        )
    )
    connection.execute(
        update(tables.session)
        .where(tables.session.c.session_id == caller.session_id)
        .values(
            screen_w_px=env.screen_w,
            screen_h_px=env.screen_h,
            device_pixel_ratio=env.device_pixel_ratio,
            **measured,
        )
    )
    if result.ends_session:
        set_state(connection, caller, "screened_out")
        end_session(connection, caller, now)
    return with_verdict(connection, caller, accept(connection, caller, post))


def last_check(connection: Connection, session_id: str) -> Any:
    check = tables.screen_check.c
    return connection.execute(
        select(tables.screen_check)
        .where(check.session_id == session_id)
        .order_by(check.check_id.desc())
        .limit(1)
    ).first()


def last_verdict(connection: Connection, caller: Caller) -> str | None:
    row = last_check(connection, caller.session_id)
    return None if row is None else str(row.verdict)


def with_verdict(connection: Connection, caller: Caller, reply: Reply) -> Reply:
    row = last_check(connection, caller.session_id)
    if reply.status >= 400 or row is None:
        return reply
    verdict = {
        "verdict": row.verdict,
        "px_per_degree": row.px_per_degree,
        "problems": json.loads(row.problems_json),
    }
    return dataclasses.replace(reply, body={**reply.body, **verdict})


def store_instructions(
    connection: Connection, opened: OpenStudy, caller: Caller, post: Post, body: InstructionsBody
) -> Reply:
    """Notes that the instructions were read; the trials begin."""
    del body
    if earlier := answer_of_earlier(connection, caller, post):
        return earlier
    if caller.state in ("active", "completed"):
        return accept(connection, caller, post, "already_answered")
    is_checked = opened.study.screen is None or last_verdict(connection, caller) in (
        "passed",
        "flagged",
    )
    if caller.state != "consented" or not is_checked:
        raise out_of_order(caller)
    set_state(connection, caller, "active")
    return accept(connection, caller, post)


def store_end(
    connection: Connection, opened: OpenStudy, caller: Caller, post: Post, body: EndBody
) -> Reply:
    """Stores the answers to the questions at the end; the session is complete then."""
    if earlier := answer_of_earlier(connection, caller, post):
        return earlier
    if caller.state == "completed":
        return accept(connection, caller, post, "already_answered")
    trial = tables.trial.c
    num_open = connection.scalar(
        select(func.count()).where(
            trial.participant_id == caller.participant_id, trial.answered_utc.is_(None)
        )
    )
    if caller.state != "active" or num_open or not opened.study.end_questions:
        raise out_of_order(caller)
    check_answers([(q, None) for q in opened.study.end_questions], body.responses)
    now = utc_now()
    for response in body.responses:
        if response.value is None and not (response.value_text or "").strip():
            continue
        connection.execute(
            insert(tables.session_answer).values(
                participant_id=caller.participant_id,
                session_id=caller.session_id,
                question_id=opened.question_ids[response.question],
                item=response.item,
                value=response.value,
                value_text=response.value_text,
                rt_ms=response.rt_ms,
                num_changes=response.num_changes,
                reversed=int(response.reversed),
                answered_utc=now,
            )
        )
    finish(connection, caller, now)
    return accept(connection, caller, post)


def store_stop(
    connection: Connection, opened: OpenStudy, caller: Caller, post: Post, body: StopBody
) -> Reply:
    """Ends a session early; the answers given so far are kept."""
    del body
    if earlier := answer_of_earlier(connection, caller, post):
        return earlier
    if opened.study.completion.partial is None or caller.state not in ("consented", "active"):
        raise ApiError(409, "cannot_stop", "this session cannot be ended early here", "close it")
    set_state(connection, caller, "stopped")
    end_session(connection, caller, utc_now())
    return accept(connection, caller, post)


def finish(connection: Connection, caller: Caller, now: str) -> None:
    set_state(connection, caller, "completed", completed_utc=now)
    end_session(connection, caller, now)


def set_state(connection: Connection, caller: Caller, state: str, **more: str) -> None:
    connection.execute(
        update(tables.participant)
        .where(tables.participant.c.participant_id == caller.participant_id)
        .values(state=state, **more)
    )


def end_session(connection: Connection, caller: Caller, now: str) -> None:
    connection.execute(
        update(tables.session)
        .where(tables.session.c.session_id == caller.session_id)
        .values(ended_utc=now)
    )


def out_of_order(caller: Caller) -> ApiError:
    return ApiError(
        409,
        "out_of_order",
        f"this is not the next step (the participant is {caller.state})",
        "ask GET /api/next",
    )
