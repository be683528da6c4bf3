# SPDX-License-Identifier: MIT
"""What the administration page shows, read in one transaction."""

from __future__ import annotations

from collections import Counter
from typing import Any

from sqlalchemy import Connection, func, select

from verisim.study.server import tables as t
from verisim.study.server.database import utc_now
from verisim.study.server.lists import UNFINISHED, count_states, earlier
from verisim.study.server.open_study import OpenStudy
from verisim.study.server.redaction import REDACTED

MAX_PEOPLE = 500
MAX_COMMENTS = 30
MAX_LOG = 30
AT_WORK_MIN = 5

Figures = dict[str, Any]


def read_figures(connection: Connection, opened: OpenStudy, mode: str) -> Figures:
    """Returns everything the page shows."""
    study = connection.execute(select(t.study)).mappings().one()
    people = read_people(connection, opened)
    return {
        "study": dict(study),
        "mode": mode,
        "now_utc": utc_now(),
        "cells": read_cells(connection, opened),
        "people": people,
        "num_people": connection.scalar(select(func.count()).select_from(t.participant)),
        "at_work": count_at_work(connection),
        "playback": read_playback(connection),
        "screens": read_screens(connection),
        "comments": read_comments(connection),
        "remarks": read_remarks(connection),
        "links": rows(connection, select(t.invitation).order_by(t.invitation.c.invitation_id)),
        "outside_ids": connection.scalar(select(func.count()).select_from(t.participant_link)),
        "erasures": connection.scalar(select(func.count()).select_from(t.erasure)),
        "deviations": rows(
            connection, select(t.deviation).order_by(t.deviation.c.deviation_id.desc())
        ),
        "log": rows(
            connection,
            select(t.admin_audit).order_by(t.admin_audit.c.audit_id.desc()).limit(MAX_LOG),
        ),
    }


def rows(connection: Connection, query: Any) -> list[dict[str, Any]]:
    return [dict(row) for row in connection.execute(query).mappings()]


def read_cells(connection: Connection, opened: OpenStudy) -> list[dict[str, Any]]:
    order = opened.study.order
    counts = count_states(connection)
    quota = order.between.quota if order.between else None
    cells = order.cells(opened.stimulus_set.stimuli)
    shown = []
    for cell in dict.fromkeys([*cells, *counts]):
        num = counts.get(cell, Counter())
        row: dict[str, Any] = {"name": cell or "everybody", "quota": quota}
        row |= {s: num[s] for s in ("completed", "stopped", "screened_out", "declined")}
        row["unfinished"] = sum(num[state] for state in UNFINISHED)
        shown.append(row)
    return shown


def count_at_work(connection: Connection) -> int:
    """Participants whose page sent something in the last minutes."""
    since = earlier(utc_now(), AT_WORK_MIN)
    query = (
        select(func.count())
        .select_from(t.session.join(t.participant))
        .where(t.session.c.last_seen_utc >= since, t.participant.c.state.in_(UNFINISHED))
    )
    return int(connection.scalar(query) or 0)


def read_people(connection: Connection, opened: OpenStudy) -> list[dict[str, Any]]:
    """The newest participants: progress, playback, and what may need a look."""
    p, s, tr, pr = t.participant.c, t.session.c, t.trial.c, t.presentation.c
    trials = (
        select(
            tr.participant_id,
            func.count().label("planned"),
            func.count(tr.answered_utc).label("answered"),
        )
        .group_by(tr.participant_id)
        .subquery()
    )
    shown = (
        select(
            tr.participant_id,
            func.sum(pr.frames_dropped).label("dropped"),
            func.sum(pr.frames_total).label("frames"),
            func.sum(pr.stall_count).label("stalls"),
            func.sum(pr.hidden_ms).label("hidden_ms"),
            func.sum(1 - pr.completed).label("broken_off"),
        )
        .join_from(t.presentation, t.trial, pr.trial_id == tr.trial_id)
        .group_by(tr.participant_id)
        .subquery()
    )
    query = (
        select(
            p.participant_id,
            p.source,
            p.state,
            p.cell,
            p.enrolled_utc,
            s.last_seen_utc,
            s.browser,
            s.refresh_hz,
            trials.c.planned,
            trials.c.answered,
            shown.c.dropped,
            shown.c.frames,
            shown.c.stalls,
            shown.c.hidden_ms,
            shown.c.broken_off,
        )
        .join_from(t.participant, t.session)
        .join(trials, trials.c.participant_id == p.participant_id)
        .outerjoin(shown, shown.c.participant_id == p.participant_id)
        .order_by(p.enrolled_utc.desc())
        .limit(MAX_PEOPLE)
    )
    people = rows(connection, query)
    checks = {
        row.session_id: row.verdict
        for row in connection.execute(
            select(s.participant_id.label("session_id"), t.screen_check.c.verdict)
            .join_from(t.screen_check, t.session)
            .order_by(t.screen_check.c.check_id)
        )
    }
    limit_min = opened.study.order.reclaim_after_min
    long_ago = earlier(utc_now(), limit_min)
    for person in people:
        share = (person["dropped"] or 0) / person["frames"] if person["frames"] else 0.0
        person["dropped_share"] = share
        flags = []
        if share > 0.05:
            flags.append("dropped frames")
        if (person["stalls"] or 0) > 0:
            flags.append("stalls")
        if (person["hidden_ms"] or 0) > 0:
            flags.append("page out of sight")
        if (person["broken_off"] or 0) > 0:
            flags.append("showing broken off")
        if checks.get(person["participant_id"]) in ("flagged", "refused"):
            flags.append(f"screen {checks[person['participant_id']]}")
        if person["state"] in UNFINISHED and person["last_seen_utc"] < long_ago:
            flags.append(f"away for more than {limit_min} min")
        person["flags"] = ", ".join(flags)
    return people


def read_playback(connection: Connection) -> list[dict[str, Any]]:
    """Dropped frames and stalls by clip, the worst first."""
    c, s = t.presentation_clip.c, t.stimulus.c
    query = (
        select(
            s.name,
            func.count().label("shown"),
            func.sum(c.frames_dropped).label("dropped"),
            func.sum(c.frames_total).label("frames"),
            func.sum(c.stall_count).label("stalls"),
            func.sum(c.stall_ms).label("stall_ms"),
        )
        .join_from(t.presentation_clip, t.stimulus)
        .group_by(s.name)
    )
    found = rows(connection, query)
    for row in found:
        row["dropped_share"] = (row["dropped"] or 0) / row["frames"] if row["frames"] else 0.0
    return sorted(found, key=lambda row: (-row["dropped_share"], -row["stalls"], row["name"]))[:20]


def read_screens(connection: Connection) -> dict[str, int]:
    check = t.screen_check.c
    query = select(check.verdict, func.count()).group_by(check.verdict)
    return {row[0]: row[1] for row in connection.execute(query)}


def read_comments(connection: Connection) -> list[dict[str, Any]]:
    query = (
        select(
            t.comment.c.comment_id,
            t.comment.c.body,
            t.comment.c.redacted,
            t.comment.c.answered_utc,
            t.question.c.key,
            t.stimulus.c.name,
            t.trial.c.participant_id,
        )
        .join_from(t.comment, t.question)
        .join(t.trial, t.trial.c.trial_id == t.comment.c.trial_id)
        .join(t.stimulus, t.stimulus.c.stimulus_id == t.trial.c.stimulus_a)
        .order_by(t.comment.c.comment_id.desc())
        .limit(MAX_COMMENTS)
    )
    return rows(connection, query)


def read_remarks(connection: Connection) -> list[dict[str, Any]]:
    """Free texts from the end of the session."""
    answer = t.session_answer.c
    query = (
        select(answer.answer_id, answer.value_text, answer.answered_utc, t.question.c.key)
        .join_from(t.session_answer, t.question)
        .where(t.question.c.kind == "comment")
        .order_by(answer.answer_id.desc())
        .limit(MAX_COMMENTS)
    )
    return [{**row, "redacted": row["value_text"] == REDACTED} for row in rows(connection, query)]
