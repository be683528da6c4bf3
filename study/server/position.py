# SPDX-License-Identifier: MIT
"""Where a participant is: the first step that is not done. The page asks, the server knows."""

from __future__ import annotations

from typing import Any

from sqlalchemy import Connection, func, select

from verisim.study.server import tables
from verisim.study.server.open_study import OpenStudy
from verisim.study.server.stimulus_set import Stimulus
from verisim.study.server.submissions import Caller

STEPS = {
    "enrolled": "consent",
    "consented": "instructions",
    "active": "trial",
    "completed": "thanks",
    "declined": "declined",
    "withdrawn": "declined",
}


def next_step(connection: Connection, opened: OpenStudy, caller: Caller) -> dict[str, Any]:
    """Returns the answer of GET /api/next."""
    trial = tables.trial.c
    mine = trial.participant_id == caller.participant_id
    total, done = connection.execute(
        select(func.count(), func.count(trial.answered_utc)).where(mine)
    ).one()
    step = STEPS[caller.state]
    return {
        "step": step,
        "progress": {"done": done, "total": total},
        "completion_code": caller.completion_code if step == "thanks" else None,
        "trial": first_open_trial(connection, opened, caller) if step == "trial" else None,
    }


def first_open_trial(connection: Connection, opened: OpenStudy, caller: Caller) -> dict[str, Any]:
    trial = tables.trial.c
    mine = select(tables.trial).where(trial.participant_id == caller.participant_id)
    row = connection.execute(
        mine.where(trial.answered_utc.is_(None)).order_by(trial.trial_index).limit(1)
    ).one()
    previous = connection.execute(mine.where(trial.trial_index == row.trial_index - 1)).first()
    stimuli = opened.stimulus_by_id()
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
        "clips": [describe_clip(stimuli[number]) for number in shown],
        "question_keys": [question.key for question in opened.study.questions],
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
