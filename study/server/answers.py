# SPDX-License-Identifier: MIT
"""Stores what a participant sends: consent, instructions read, answers, showings, events."""

from __future__ import annotations

from typing import Any

from sqlalchemy import Connection, Row, func, insert, select, update
from sqlalchemy.dialects.sqlite import insert as insert_or

from verisim.study.server import tables
from verisim.study.server.api_error import ApiError
from verisim.study.server.bodies import (
    ConsentBody,
    EventsBody,
    InstructionsBody,
    Presentation,
    PresentationBody,
    Response,
    TrialBody,
)
from verisim.study.server.database import utc_now
from verisim.study.server.open_study import OpenStudy, to_json
from verisim.study.server.questions.question import Answer
from verisim.study.server.reply import Reply
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


def store_instructions(
    connection: Connection, opened: OpenStudy, caller: Caller, post: Post, body: InstructionsBody
) -> Reply:
    """Notes that the instructions were read; the trials begin."""
    del opened, body
    if earlier := answer_of_earlier(connection, caller, post):
        return earlier
    if caller.state in ("active", "completed"):
        return accept(connection, caller, post, "already_answered")
    if caller.state != "consented":
        raise out_of_order(caller)
    set_state(connection, caller, "active")
    return accept(connection, caller, post)


def store_trial(
    connection: Connection, opened: OpenStudy, caller: Caller, post: Post, body: TrialBody
) -> Reply:
    """Stores a showing and its answers. The first answers stand; later ones are only logged."""
    if earlier := answer_of_earlier(connection, caller, post):
        return earlier
    trial = find_trial(connection, caller, body.trial_id)
    if trial.answered_utc is not None:
        return accept(connection, caller, post, "already_answered")
    first_open = select(func.min(tables.trial.c.trial_index)).where(
        tables.trial.c.participant_id == caller.participant_id,
        tables.trial.c.answered_utc.is_(None),
    )
    if caller.state != "active" or connection.scalar(first_open) != trial.trial_index:
        raise out_of_order(caller)
    if not body.presentation.completed or body.presentation.num_plays < 1:
        raise invalid("presentation", "an answer needs a clip that was played to its end")
    check_answers(opened, body.responses)
    now = utc_now()
    store_showing(connection, caller, trial.trial_id, body.presentation, now)
    for response in body.responses:
        store_response(connection, opened, trial.trial_id, body, response, now)
    connection.execute(
        update(tables.trial)
        .where(tables.trial.c.trial_id == trial.trial_id)
        .values(answered_utc=now)
    )
    if connection.scalar(first_open) is None:
        set_state(connection, caller, "completed", completed_utc=now)
        end_session(connection, caller, now)
    return accept(connection, caller, post)


def store_presentation(
    connection: Connection, opened: OpenStudy, caller: Caller, post: Post, body: PresentationBody
) -> Reply:
    """Stores a showing that was broken off."""
    del opened
    if earlier := answer_of_earlier(connection, caller, post):
        return earlier
    trial = find_trial(connection, caller, body.trial_id)
    if body.presentation.completed:
        raise invalid("presentation.completed", "a completed showing comes with its answers")
    store_showing(connection, caller, trial.trial_id, body.presentation, utc_now())
    return accept(connection, caller, post)


def store_events(
    connection: Connection, opened: OpenStudy, caller: Caller, post: Post, body: EventsBody
) -> Reply:
    """Stores what happened on the page; an event whose number is known is left as it is."""
    del opened
    if earlier := answer_of_earlier(connection, caller, post):
        return earlier
    rows = [
        {
            "session_id": caller.session_id,
            "seq": event.seq,
            "presentation_id": event.presentation_id,
            "kind": event.kind,
            "t_ms": event.t_ms,
            "detail_json": None if event.detail is None else to_json(event.detail),
        }
        for event in body.events
    ]
    connection.execute(insert_or(tables.event).on_conflict_do_nothing(), rows)
    return accept(connection, caller, post)


def find_trial(connection: Connection, caller: Caller, trial_id: int) -> Row[Any]:
    """Returns the caller's trial; one that is missing looks like one of somebody else."""
    trial = connection.execute(
        select(tables.trial).where(
            tables.trial.c.trial_id == trial_id,
            tables.trial.c.participant_id == caller.participant_id,
        )
    ).first()
    if trial is None:
        raise ApiError(403, "not_yours", "this trial is not yours", "ask GET /api/next")
    return trial


def check_answers(opened: OpenStudy, responses: list[Response]) -> None:
    """Refuses unknown, repeated, missing and impossible answers; all faults in one reply."""
    questions = {question.key: question for question in opened.study.questions}
    faults: list[str] = []
    answered: set[str] = set()
    for response in responses:
        question = questions.get(response.question)
        if question is None:
            faults.append(f"{response.question}: unknown; asked are {', '.join(questions)}")
            continue
        if response.question in answered:
            faults.append(f"{response.question}: answered twice")
        answered.add(response.question)
        if is_skipped(response):
            if not question.optional:
                faults.append(f"{response.question}: needs an answer")
        elif fault := question.find_fault(Answer(response.value, response.value_text)):
            faults.append(f"{response.question}: {fault}")
    for question in questions.values():
        if not question.optional and question.key not in answered:
            faults.append(f"{question.key}: answer missing")
    if faults:
        raise invalid("responses", "; ".join(faults))


def is_skipped(response: Response) -> bool:
    return response.value is None and not (response.value_text or "").strip()


def store_showing(
    connection: Connection, caller: Caller, trial_id: int, shown: Presentation, now: str
) -> None:
    """Adds a showing; the final record of one reported as broken off replaces that report."""
    values = {
        "presentation_id": shown.presentation_id,
        "trial_id": trial_id,
        "session_id": caller.session_id,
        "num_plays": shown.num_plays,
        "onset_ms": shown.onset_ms,
        "first_frame_ms": shown.first_frame_ms,
        "ended_ms": shown.ended_ms,
        "frames_total": shown.frames_total,
        "frames_dropped": shown.frames_dropped,
        "stall_count": shown.stall_count,
        "stall_ms": shown.stall_ms,
        "hidden_ms": shown.hidden_ms,
        "fullscreen": int(shown.fullscreen),
        "displayed_w_px": shown.displayed_w,
        "displayed_h_px": shown.displayed_h,
        "completed": int(shown.completed),
        "received_utc": now,
    }
    same = tables.presentation.c.presentation_id == shown.presentation_id
    known = connection.execute(select(tables.presentation).where(same)).first()
    if known is None:
        connection.execute(insert(tables.presentation).values(values))
    elif (known.session_id, known.trial_id) != (caller.session_id, trial_id):
        raise ApiError(403, "not_yours", "this presentation_id is in use", "use a new one")
    elif not known.completed:
        connection.execute(update(tables.presentation).where(same).values(values))


def store_response(
    connection: Connection,
    opened: OpenStudy,
    trial_id: int,
    body: TrialBody,
    response: Response,
    now: str,
) -> None:
    if is_skipped(response):
        return
    common = {
        "presentation_id": body.presentation.presentation_id,
        "trial_id": trial_id,
        "question_id": opened.question_ids[response.question],
        "rt_ms": response.rt_ms,
        "answered_utc": now,
    }
    if opened.study.question(response.question).scale() is None:
        connection.execute(insert(tables.comment).values(body=response.value_text, **common))
        return
    connection.execute(
        insert(tables.response).values(
            value=response.value,
            value_text=response.value_text,
            rt_origin=response.rt_origin,
            first_touch_ms=response.first_touch_ms,
            num_changes=response.num_changes,
            **common,
        )
    )


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


def invalid(where: str, message: str) -> ApiError:
    return ApiError(422, "invalid", f"{where}: {message}", "correct the body")
