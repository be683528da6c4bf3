# SPDX-License-Identifier: MIT
"""Stores what the screen did: one row per showing, one per clip of it, in the order shown."""

from __future__ import annotations

from typing import Any

from sqlalchemy import Connection, Row, bindparam, delete, insert, select, update

from verisim.study.server import tables
from verisim.study.server.api_error import ApiError
from verisim.study.server.asked import invalid
from verisim.study.server.bodies import Presentation
from verisim.study.server.open_study import OpenStudy
from verisim.study.server.submissions import Caller

# Built once: every answer needs them.
_TRIAL = select(tables.trial).where(
    tables.trial.c.trial_id == bindparam("trial"),
    tables.trial.c.participant_id == bindparam("who"),
)
_SHOWING = select(tables.presentation).where(
    tables.presentation.c.presentation_id == bindparam("shown")
)
_ADD_SHOWING = insert(tables.presentation)
_ADD_CLIPS = insert(tables.presentation_clip)


def find_trial(connection: Connection, caller: Caller, trial_id: int) -> Row[Any]:
    """Returns the caller's trial; one that is missing looks like one of somebody else."""
    trial = connection.execute(_TRIAL, {"trial": trial_id, "who": caller.participant_id}).first()
    if trial is None:
        raise ApiError(403, "not_yours", "this trial is not yours", "ask GET /api/next")
    return trial


def planned_ids(trial: Row[Any]) -> list[int]:
    return [number for number in (trial.stimulus_a, trial.stimulus_b) if number is not None]


def check_showing(opened: OpenStudy, trial: Row[Any], shown: Presentation) -> None:
    """Refuses a showing of clips that are not this trial's. In which order they came may differ."""
    planned = {opened.stimulus_by_id[number].sha256 for number in planned_ids(trial)}
    if len({clip.position for clip in shown.clips}) < len(shown.clips):
        raise invalid("presentation.clips", "two clips have the same position")
    foreign = [clip.sha256 for clip in shown.clips if clip.sha256 not in planned]
    if foreign:
        raise invalid("presentation.clips", f"{foreign[0][:12]}… is no clip of this trial")


def store_showing(
    connection: Connection,
    opened: OpenStudy,
    caller: Caller,
    trial: Row[Any],
    shown: Presentation,
    now: str,
) -> None:
    """Adds a showing; the final record of one reported as broken off replaces that report."""
    check_showing(opened, trial, shown)
    values = {
        "presentation_id": shown.presentation_id,
        "trial_id": trial.trial_id,
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
        "device_pixel_ratio": shown.device_pixel_ratio,
        "scale": shown.scale,
        "num_mark_plays": shown.num_mark_plays,
        "blur_count": shown.blur_count,
        "fullscreen_exits": shown.fullscreen_exits,
        "start_skew_ms": shown.start_skew_ms,
    }
    known = connection.execute(_SHOWING, {"shown": shown.presentation_id}).first()
    if known is None:
        connection.execute(_ADD_SHOWING, values)
    elif (known.session_id, known.trial_id) != (caller.session_id, trial.trial_id):
        raise ApiError(403, "not_yours", "this presentation_id is in use", "use a new one")
    elif known.completed:
        return
    else:
        same = tables.presentation.c.presentation_id == shown.presentation_id
        connection.execute(update(tables.presentation).where(same).values(values))
    if known is not None:
        own = tables.presentation_clip.c.presentation_id == shown.presentation_id
        connection.execute(delete(tables.presentation_clip).where(own))
    if shown.clips:
        by_sha = {opened.stimulus_by_id[n].sha256: n for n in planned_ids(trial)}
        rows = [
            clip.model_dump(exclude={"sha256"})
            | {"presentation_id": shown.presentation_id, "stimulus_id": by_sha[clip.sha256]}
            for clip in shown.clips
        ]
        connection.execute(_ADD_CLIPS, rows)
