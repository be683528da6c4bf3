# SPDX-License-Identifier: MIT
"""Reads the exported tables from one moment of the database."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Connection, func, select

from verisim.study.server import tables as t
from verisim.study.server.expected import is_as_expected, read_expected

Row = dict[str, Any]
Clip = tuple[Row, Row]  # stimulus row, factor columns


@dataclass(frozen=True)
class Snapshot:
    """All that the tables are made from, read in one transaction."""

    study: Row
    config: dict[str, Any]
    factor_names: list[str]
    stimuli: list[Row]
    by_id: dict[int, Row]
    connection: Connection

    @property
    def name(self) -> str:
        return str(self.study["study_id"])


def take_snapshot(connection: Connection) -> Snapshot | None:
    """Returns what the tables are made from, None for a database without a study."""
    study = connection.execute(select(t.study)).mappings().first()
    if study is None:
        return None
    joined = (
        select(t.stimulus, t.study_stimulus.c.role, t.condition.c.factors_json)
        .join_from(t.stimulus, t.study_stimulus)
        .join(t.condition)
        .order_by(t.stimulus.c.name)
    )
    stimuli: list[Row] = []
    names: set[str] = set()
    for found in connection.execute(joined).mappings():
        row = dict(found)
        factors = json.loads(row.pop("factors_json"))
        names.update(factors)
        row["factors"] = {f"factor_{name}": level or None for name, level in factors.items()}
        stimuli.append(row)
    return Snapshot(
        study=dict(study),
        config=json.loads(study["config_json"]),
        factor_names=[f"factor_{name}" for name in sorted(names)],
        stimuli=stimuli,
        by_id={row["stimulus_id"]: row for row in stimuli},
        connection=connection,
    )


def clip_columns(snapshot: Snapshot, row: Row) -> Row:
    """The columns that name the clips of a trial; the scene, method and factors are the first's."""
    first = snapshot.by_id[row["stimulus_a"]]
    second = snapshot.by_id.get(row["stimulus_b"])
    return {
        "stimulus": first["name"],
        "stimulus_sha256": first["sha256"],
        "stimulus_b": second["name"] if second else None,
        "stimulus_b_sha256": second["sha256"] if second else None,
        "scene": first["scene"],
        "method": first["method"],
        **first["factors"],
    }


def participants(snapshot: Snapshot) -> list[Row]:
    trials = (
        select(
            t.trial.c.participant_id,
            func.count().label("num_trials_planned"),
            func.count(t.trial.c.answered_utc).label("num_trials_answered"),
        )
        .group_by(t.trial.c.participant_id)
        .subquery()
    )
    query = (
        select(
            t.participant,
            t.consent.c.form_version.label("consent_version"),
            t.consent.c.form_sha256.label("consent_sha256"),
            t.consent.c.language.label("consent_language"),
            t.consent.c.agreed,
            t.consent.c.answered_utc.label("consented_utc"),
            t.assignment.c.list_no,
            t.assignment.c.algorithm.label("order_algorithm"),
            t.assignment.c.seed.label("order_seed"),
            t.assignment.c.order_sha256,
            trials.c.num_trials_planned,
            trials.c.num_trials_answered,
        )
        .join_from(t.participant, t.assignment)
        .join(trials, trials.c.participant_id == t.participant.c.participant_id)
        .outerjoin(t.consent, t.consent.c.participant_id == t.participant.c.participant_id)
        .order_by(t.participant.c.enrolled_utc, t.participant.c.participant_id)
    )
    rows = fetch(snapshot, query)
    for row in rows:
        if not row["agreed"]:
            row["consented_utc"] = None
    return rows


def sessions(snapshot: Snapshot) -> list[Row]:
    query = (
        select(t.session, t.participant.c.source)
        .join_from(t.session, t.participant)
        .order_by(t.session.c.started_utc, t.session.c.session_id)
    )
    rows = fetch(snapshot, query)
    checks = select(t.screen_check).order_by(t.screen_check.c.check_id)
    last = {row.session_id: row for row in snapshot.connection.execute(checks)}
    for row in rows:
        check = last.get(row["session_id"])
        row["screen_verdict"] = check.verdict if check else None
        problems = json.loads(check.problems_json) if check else []
        row["screen_problems"] = " ".join(problem["code"] for problem in problems) or None
    return rows


def shown_trials() -> Any:
    """A query of every showing with its trial and person; the tables below build on it."""
    return (
        select(
            t.presentation,
            t.session.c.participant_id,
            t.participant.c.source,
            t.trial.c.trial_index,
            t.trial.c.trial_kind,
            t.trial.c.block,
            t.trial.c.layout,
            t.trial.c.stimulus_a,
            t.trial.c.stimulus_b,
            t.trial.c.track,
            t.trial.c.expected_json,
        )
        .join_from(t.presentation, t.trial, t.presentation.c.trial_id == t.trial.c.trial_id)
        .join(t.session, t.session.c.session_id == t.presentation.c.session_id)
        .join(t.participant, t.participant.c.participant_id == t.session.c.participant_id)
    )


def in_order(query: Any) -> Any:
    return query.order_by(
        t.participant.c.enrolled_utc,
        t.participant.c.participant_id,
        t.trial.c.trial_index,
        t.presentation.c.received_utc,
        t.presentation.c.presentation_id,
    )


def presentations(snapshot: Snapshot) -> list[Row]:
    rows = fetch(snapshot, in_order(shown_trials()))
    return [{**row, **clip_columns(snapshot, row)} for row in rows]


def ratings(snapshot: Snapshot) -> list[Row]:
    query = (
        shown_trials()
        .join(t.response, t.response.c.presentation_id == t.presentation.c.presentation_id)
        .join(t.question, t.question.c.question_id == t.response.c.question_id)
        .add_columns(
            t.question.c.key.label("question"),
            t.question.c.kind.label("question_kind"),
            t.response.c.value,
            t.response.c.value_text,
            t.response.c.item,
            t.response.c.rt_ms,
            t.response.c.rt_origin,
            t.response.c.rt_onset_ms,
            t.response.c.num_changes,
            t.response.c.reversed,
            t.response.c.answered_utc,
        )
    )
    rows = fetch(snapshot, in_order(query).order_by(t.response.c.question_id, t.response.c.item))
    return [{**row, **clip_columns(snapshot, row), "correct": correct(row)} for row in rows]


def correct(row: Row) -> int | None:
    """1 where the answer is the expected one, 0 where not, None where none is expected."""
    expected = read_expected(row["expected_json"])
    if expected is None or expected["question"] != row["question"]:
        return None
    return int(is_as_expected(expected, row["value"]))


def shown_clips(snapshot: Snapshot) -> list[Row]:
    query = (
        select(
            t.presentation_clip,
            t.session.c.participant_id,
            t.session.c.session_id,
            t.participant.c.source,
            t.trial.c.stimulus_a,
        )
        .join_from(t.presentation_clip, t.presentation)
        .join(t.trial, t.trial.c.trial_id == t.presentation.c.trial_id)
        .join(t.session, t.session.c.session_id == t.presentation.c.session_id)
        .join(t.participant, t.participant.c.participant_id == t.session.c.participant_id)
    )
    rows = fetch(snapshot, in_order(query).order_by(t.presentation_clip.c.position))
    for row in rows:
        clip = snapshot.by_id[row["stimulus_id"]]
        row["stimulus"], row["stimulus_sha256"] = clip["name"], clip["sha256"]
        row["planned_position"] = int(row["stimulus_id"] != row["stimulus_a"])
    return rows


def end_answers(snapshot: Snapshot) -> tuple[list[Row], list[Row]]:
    """Returns the answers to the questions at the end: those with a scale or options, and texts."""
    query = (
        select(
            t.session_answer,
            t.question.c.key.label("question"),
            t.question.c.kind.label("question_kind"),
            t.session_answer.c.value_text.label("comment"),
            t.participant.c.source,
        )
        .join_from(t.session_answer, t.question)
        .join(t.participant, t.participant.c.participant_id == t.session_answer.c.participant_id)
        .order_by(
            t.participant.c.enrolled_utc,
            t.participant.c.participant_id,
            t.session_answer.c.question_id,
            t.session_answer.c.item,
        )
    )
    rows = fetch(snapshot, query)
    texts = [row for row in rows if row["question_kind"] == "comment"]
    return [row for row in rows if row["question_kind"] != "comment"], texts


def comments(snapshot: Snapshot) -> list[Row]:
    query = (
        shown_trials()
        .join(t.comment, t.comment.c.presentation_id == t.presentation.c.presentation_id)
        .join(t.question, t.question.c.question_id == t.comment.c.question_id)
        .add_columns(
            t.question.c.key.label("question"),
            t.comment.c.body.label("comment"),
            t.comment.c.answered_utc,
        )
    )
    rows = fetch(snapshot, in_order(query).order_by(t.comment.c.question_id))
    return [{**row, **clip_columns(snapshot, row)} for row in rows]


def events(snapshot: Snapshot) -> list[Row]:
    query = (
        select(
            t.event,
            t.event.c.detail_json.label("detail"),
            t.session.c.participant_id,
            t.participant.c.source,
        )
        .join_from(t.event, t.session)
        .join(t.participant, t.participant.c.participant_id == t.session.c.participant_id)
        .order_by(t.session.c.started_utc, t.session.c.session_id, t.event.c.seq)
    )
    # A tab that is closed at once may send an event of a showing and never the showing itself.
    known = set(snapshot.connection.scalars(select(t.presentation.c.presentation_id)))
    rows = fetch(snapshot, query)
    for row in rows:
        if row["presentation_id"] not in known:
            row["presentation_id"] = None
    return rows


def stimuli(snapshot: Snapshot) -> list[Row]:
    return [
        {**row, **row["factors"], "stimulus": row["name"], "source": "stimulus"}
        for row in snapshot.stimuli
    ]


def questions(snapshot: Snapshot) -> list[Row]:
    return fetch(snapshot, select(t.question).order_by(t.question.c.question_id))


def fetch(snapshot: Snapshot, query: Any) -> list[Row]:
    study = {"study": snapshot.name}
    return [{**study, **row} for row in snapshot.connection.execute(query).mappings()]
