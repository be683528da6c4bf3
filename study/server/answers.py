# SPDX-License-Identifier: MIT
"""Stores what a participant answers: trials, showings that were broken off, events."""

from __future__ import annotations

import dataclasses
from typing import Any

from sqlalchemy import Connection, Row, bindparam, func, insert, select, update

from verisim.study.server import tables
from verisim.study.server.adaptive import choose_next_clip
from verisim.study.server.asked import check_answers, invalid, questions_of_trial
from verisim.study.server.bodies import EventsBody, PresentationBody, Response, TrialBody
from verisim.study.server.database import insert_for, utc_now
from verisim.study.server.expected import is_as_expected, read_expected
from verisim.study.server.json_text import to_json
from verisim.study.server.open_study import OpenStudy
from verisim.study.server.reply import Reply
from verisim.study.server.showings import find_trial, store_showing
from verisim.study.server.steps import finish, out_of_order
from verisim.study.server.submissions import Caller, Post, accept, answer_of_earlier

# Built once: every answer needs them.
_ANSWERED = (
    update(tables.trial)
    .where(tables.trial.c.trial_id == bindparam("trial"))
    .values(answered_utc=bindparam("now"))
)
_OPEN = select(func.min(tables.trial.c.trial_index), func.count()).where(
    tables.trial.c.participant_id == bindparam("who"), tables.trial.c.answered_utc.is_(None)
)


def store_trial(
    connection: Connection, opened: OpenStudy, caller: Caller, post: Post, body: TrialBody
) -> Reply:
    """Stores a showing and its answers. The first answers stand; later ones are only logged."""
    if earlier := answer_of_earlier(connection, caller, post):
        trial = find_trial(connection, caller, body.trial_id)
        return with_feedback(connection, opened, trial, earlier)
    trial = find_trial(connection, caller, body.trial_id)
    if trial.answered_utc is not None:
        return accept(connection, caller, post, "already_answered")
    first_open, num_open = connection.execute(_OPEN, {"who": caller.participant_id}).one()
    if caller.state != "active" or first_open != trial.trial_index:
        raise out_of_order(caller)
    if not body.presentation.completed or body.presentation.num_plays < 1:
        raise invalid("presentation", "an answer needs a clip that was played to its end")
    asked = questions_of_trial(opened.study.questions, caller.seed, trial.trial_index)
    check_answers(asked, body.responses)
    now = utc_now()
    store_showing(connection, opened, caller, trial, body.presentation, now)
    store_responses(connection, opened, trial.trial_id, body, now)
    connection.execute(_ANSWERED, {"trial": trial.trial_id, "now": now})
    if num_open > 1:
        choose_next_clip(connection, opened, caller.participant_id)
    elif not opened.study.end_questions:
        finish(connection, caller, now)
    return with_feedback(connection, opened, trial, accept(connection, caller, post))


def with_feedback(
    connection: Connection, opened: OpenStudy, trial: Row[Any], reply: Reply
) -> Reply:
    """Adds what a practice trial is told; None in every other trial."""
    if reply.status >= 400:
        return reply
    return dataclasses.replace(
        reply, body={**reply.body, "feedback": make_feedback(connection, opened, trial)}
    )


def make_feedback(
    connection: Connection, opened: OpenStudy, trial: Row[Any]
) -> dict[str, Any] | None:
    expected = read_expected(trial.expected_json)
    if trial.trial_kind != "practice" or not opened.study.practice.feedback or expected is None:
        return None
    value = connection.scalar(
        select(tables.response.c.value).where(
            tables.response.c.trial_id == trial.trial_id,
            tables.response.c.question_id == opened.question_ids[expected["question"]],
        )
    )
    return {"correct": is_as_expected(expected, value), "text": None}


def store_presentation(
    connection: Connection, opened: OpenStudy, caller: Caller, post: Post, body: PresentationBody
) -> Reply:
    """Stores a showing that was broken off."""
    if earlier := answer_of_earlier(connection, caller, post):
        return earlier
    trial = find_trial(connection, caller, body.trial_id)
    if body.presentation.completed:
        raise invalid("presentation.completed", "a completed showing comes with its answers")
    store_showing(connection, opened, caller, trial, body.presentation, utc_now())
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
    connection.execute(insert_for(connection, tables.event).on_conflict_do_nothing(), rows)
    return accept(connection, caller, post)


def store_responses(
    connection: Connection, opened: OpenStudy, trial_id: int, body: TrialBody, now: str
) -> None:
    """Stores what was not skipped: numbers and options apart from free text."""
    answers: list[dict[str, Any]] = []
    comments: list[dict[str, Any]] = []
    for response in body.responses:
        if response.value is None and not (response.value_text or "").strip():
            continue
        common = {
            "presentation_id": body.presentation.presentation_id,
            "trial_id": trial_id,
            "question_id": opened.question_ids[response.question],
            "rt_ms": response.rt_ms,
            "answered_utc": now,
        }
        if opened.study.question(response.question).is_free_text:
            comments.append({"body": response.value_text, **common})
        else:
            answers.append(response_row(response) | common)
    if answers:
        connection.execute(insert(tables.response), answers)
    if comments:
        connection.execute(insert(tables.comment), comments)


def response_row(response: Response) -> dict[str, Any]:
    return {
        "value": response.value,
        "value_text": response.value_text,
        "rt_origin": response.rt_origin,
        "first_touch_ms": response.first_touch_ms,
        "num_changes": response.num_changes,
        "item": response.item,
        "rt_onset_ms": response.rt_onset_ms,
        "reversed": int(response.reversed),
    }
