# SPDX-License-Identifier: MIT
"""Where a participant is: the first step that is not done. The page asks, the server knows."""

from __future__ import annotations

import json
from typing import Any

from sqlalchemy import Connection, bindparam, func, select

from verisim.study.server import tables
from verisim.study.server.asked import questions_of_trial
from verisim.study.server.open_study import OpenStudy
from verisim.study.server.steps import last_check
from verisim.study.server.stimulus_set import Stimulus
from verisim.study.server.study_parts import Ending
from verisim.study.server.submissions import Caller
from verisim.study.server.withdrawal import withdrawal_of

STEPS = {
    "enrolled": "consent",
    "consented": "instructions",
    "active": "trial",
    "completed": "thanks",
    "declined": "declined",
    "withdrawn": "declined",
    "screened_out": "screened_out",
    "stopped": "stopped",
}
ENDINGS = {"thanks": "complete", "stopped": "partial", "screened_out": "screened_out"}


# Built once: every request asks these.
_PROGRESS = select(func.count(), func.count(tables.trial.c.answered_utc)).where(
    tables.trial.c.participant_id == bindparam("who")
)
_TWO_TRIALS = (
    select(tables.trial)
    .where(
        tables.trial.c.participant_id == bindparam("who"),
        tables.trial.c.trial_index.between(bindparam("before"), bindparam("here")),
    )
    .order_by(tables.trial.c.trial_index)
)


def next_step(connection: Connection, opened: OpenStudy, caller: Caller) -> dict[str, Any]:
    """Returns the answer of GET /api/next."""
    total, done = connection.execute(_PROGRESS, {"who": caller.participant_id}).one()
    step = STEPS[caller.state]
    check = None
    if opened.study.screen is not None and step in ("instructions", "screened_out"):
        check = last_check(connection, caller.session_id)
    if step == "instructions" and opened.study.screen is not None:
        if check is None or check.verdict == "refused":
            step = "screen"
    elif step == "trial" and done == total:
        step = "end_questions"
    completion = describe_ending(opened, caller, step, done / total if total else 1.0)
    is_over = step in ("thanks", "stopped")
    return {
        "step": step,
        "progress": {"done": done, "total": total},
        "language": caller.language,
        "completion": completion,
        "completion_code": completion["code"] if completion and step == "thanks" else None,
        "withdraw_fragment": f"withdraw={withdrawal_of(connection, caller.participant_id)}"
        if is_over
        else None,
        "screen_problems": [
            {"code": problem["code"], "fixable": problem["fixable"]}
            for problem in (json.loads(check.problems_json) if check else [])
        ]
        if step in ("screen", "screened_out")
        else [],
        "trial": describe_trial(connection, opened, caller, done) if step == "trial" else None,
    }


def describe_ending(
    opened: OpenStudy, caller: Caller, step: str, share_done: float
) -> dict[str, Any] | None:
    """Returns code and way back for the way in which the session ended."""
    kind = ENDINGS.get(step)
    if kind is None:
        return None
    completion = opened.study.completion
    ending: Ending | None = completion.complete
    if kind == "partial":
        ending = completion.partial if share_done >= completion.partial_from_share else None
    elif kind == "screened_out":
        ending = completion.screened_out
    if ending is None:
        return {"kind": kind, "code": None, "return_url": None}
    code = ending.code or caller.completion_code
    url = ending.return_url.replace("{code}", code) if ending.return_url else None
    return {"kind": kind, "code": code, "return_url": url}


def describe_trial(
    connection: Connection, opened: OpenStudy, caller: Caller, done: int
) -> dict[str, Any]:
    """Returns the first open trial: trials are answered in order, so `done` is its number."""
    rows = connection.execute(
        _TWO_TRIALS, {"who": caller.participant_id, "before": done - 1, "here": done}
    ).all()
    row, previous = rows[-1], rows[0] if len(rows) == 2 else None
    asked = questions_of_trial(opened.study.questions, caller.seed, row.trial_index)
    shown = [number for number in (row.stimulus_a, row.stimulus_b) if number is not None]
    is_practice = row.trial_kind == "practice"
    # To the participant there are two kinds: practice and the rest.
    first_of_kind = previous is None or (previous.trial_kind == "practice") != is_practice
    return {
        "trial_id": row.trial_id,
        "trial_index": row.trial_index,
        "trial_kind": row.trial_kind,
        "layout": row.layout,
        "first_of_kind": first_of_kind,
        "clips": [describe_clip(opened.stimulus_by_id[number]) for number in shown],
        "question_keys": [question.key for question, _ in asked],
        "conditions": {
            question.key: condition.page_fields() for question, condition in asked if condition
        },
        "reversed": [q.key for q, _ in asked if q.has_options and caller.buttons == "reversed"],
        "feedback": is_practice and opened.study.practice.feedback,
        "rest_before": previous is not None and previous.block > 0 and row.block > previous.block,
    }


def describe_clip(stimulus: Stimulus) -> dict[str, Any]:
    return {
        "sha256": stimulus.sha256,
        "url": f"/media/{stimulus.sha256}.mp4",
        "num_bytes": stimulus.num_bytes,
        "width_px": stimulus.width_px,
        "height_px": stimulus.height_px,
        "frame_rate_hz": stimulus.frame_rate_hz,
        "num_frames": stimulus.num_frames,
        "duration_s": stimulus.duration_s,
    }
