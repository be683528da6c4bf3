# SPDX-License-Identifier: MIT
"""The tables of a study database: what was shown is kept apart from what was answered."""

from __future__ import annotations

from typing import Any

from sqlalchemy import (
    REAL,
    BigInteger,
    CheckConstraint,
    Column,
    Double,
    ForeignKey,
    Index,
    Integer,
    MetaData,
    Table,
    Text,
    UniqueConstraint,
)
from sqlalchemy.types import TypeEngine

# Types with one meaning on every database; SQLite's STRICT tables know only INTEGER, REAL and TEXT.
INT = BigInteger().with_variant(Integer(), "sqlite")
NUM: TypeEngine[float] = Double().with_variant(REAL(), "sqlite")
TEXT = Text()

metadata = MetaData(
    naming_convention={
        "ck": "ck_%(table_name)s_%(constraint_name)s",
        "uq": "uq_%(table_name)s_%(column_0_N_name)s",
        "fk": "fk_%(table_name)s_%(column_0_N_name)s",
        "pk": "pk_%(table_name)s",
    }
)


def one_of(column: str, *values: str) -> CheckConstraint:
    return CheckConstraint(f"{column} IN ({', '.join(repr(v) for v in values)})", name=column)


def zero_or_one(column: str) -> CheckConstraint:
    return CheckConstraint(f"{column} IN (0, 1)", name=column)


def col(name: str, kind: Any, *rest: Any, null: bool = False, **options: Any) -> Column[Any]:
    return Column(name, kind, *rest, nullable=null, **options)


def key(name: str, kind: Any = TEXT, *rest: Any) -> Column[Any]:
    return Column(name, kind, *rest, primary_key=True, nullable=False)


def parent(target: str) -> ForeignKey:
    """A reference that is erased together with what it points to."""
    return ForeignKey(target, ondelete="CASCADE")


def table(name: str, *parts: Any) -> Table:
    return Table(name, metadata, *parts, sqlite_strict=True)


PARTICIPANT_STATES = (
    "enrolled",
    "consented",
    "active",
    "completed",
    "declined",
    "withdrawn",
    "screened_out",
    "stopped",
)

study = table(
    "study",
    key("study_id"),
    col("title", TEXT),
    col("config_json", TEXT),
    col("config_sha256", TEXT),
    col("set_name", TEXT),
    col("set_dir", TEXT),
    col("set_sha256", TEXT),
    col("blind_key", TEXT),
    col("state", TEXT),
    col("created_utc", TEXT),
    col("mode", TEXT, server_default="open"),
    col("withdraw_key", TEXT, server_default=""),  # secret behind the links of withdrawal
    col("frozen_json", TEXT, null=True),  # what was fixed, of a live study
    one_of("state", "open", "paused", "closed"),
)

stimulus = table(
    "stimulus",
    key("stimulus_id", INT),
    col("name", TEXT, unique=True),
    col("sha256", TEXT),
    col("scene", TEXT),
    col("method", TEXT),
    col("seed", INT, null=True),
    col("reference", TEXT),
    col("file", TEXT),
    col("num_bytes", INT),
    col("width_px", INT),
    col("height_px", INT),
    col("frame_rate_hz", NUM),
    col("num_frames", INT),
    col("duration_s", NUM),
    col("content_key", TEXT),
    col("provenance_json", TEXT),
    CheckConstraint("length(sha256) = 64", name="sha256"),
)

condition = table(
    "condition",
    key("condition_id", INT),
    col("study_id", TEXT, ForeignKey("study.study_id")),
    col("name", TEXT),
    col("factors_json", TEXT),
    UniqueConstraint("study_id", "name"),
)

study_stimulus = table(
    "study_stimulus",
    key("study_id", TEXT, ForeignKey("study.study_id")),
    key("stimulus_id", INT, ForeignKey("stimulus.stimulus_id")),
    col("condition_id", INT, ForeignKey("condition.condition_id")),
    col("role", TEXT),
    one_of("role", "test", "practice", "catch"),
)

question = table(
    "question",
    key("question_id", INT),
    col("study_id", TEXT, ForeignKey("study.study_id")),
    col("key", TEXT),
    col("version", INT),
    col("kind", TEXT),  # a name in the registry of question kinds, which grows
    col("optional", INT),
    col("scale_min", NUM, null=True),
    col("scale_max", NUM, null=True),
    col("scale_step", NUM, null=True),
    col("prompt_json", TEXT),
    col("meaning_json", TEXT),
    col("place", TEXT, server_default="trial"),  # trial | session_end
    UniqueConstraint("study_id", "key", "version"),
    zero_or_one("optional"),
)

participant = table(
    "participant",
    key("participant_id"),
    col("study_id", TEXT, ForeignKey("study.study_id")),
    col("source", TEXT),
    col("state", TEXT),
    col("completion_code", TEXT, unique=True),
    col("enrolled_utc", TEXT),
    col("completed_utc", TEXT, null=True),
    col("cell", TEXT, server_default=""),  # level of the factor that varies between people
    col("buttons", TEXT, server_default="normal"),  # normal | reversed order of options
    col("invitation_id", INT, null=True),
    CheckConstraint("length(participant_id) >= 22", name="participant_id"),
    one_of("source", "lab", "link", "prolific", "mturk", "pilot", "simulated"),
    one_of("state", *PARTICIPANT_STATES),
)

# The only place where an identifier of another platform may live; emptied first.
participant_link = table(
    "participant_link",
    key("participant_id", TEXT, parent("participant.participant_id")),
    col("platform", TEXT),
    col("external_id", TEXT),
    col("external_study", TEXT, null=True),
    col("external_session", TEXT, null=True),
    UniqueConstraint("platform", "external_id"),
)

# A link that a researcher hands out; its token is kept as a hash.
invitation = table(
    "invitation",
    key("invitation_id", INT),
    col("token_sha256", TEXT, unique=True),
    col("label", TEXT),
    col("source", TEXT),
    col("max_uses", INT, null=True),  # empty: any number
    col("num_uses", INT),
    col("state", TEXT),
    col("created_utc", TEXT),
    one_of("state", "open", "closed"),
    one_of("source", "lab", "link", "pilot"),
)

consent = table(
    "consent",
    key("consent_id", INT),
    col("participant_id", TEXT, parent("participant.participant_id"), unique=True),
    col("form_version", TEXT),
    col("form_sha256", TEXT),
    col("language", TEXT),
    col("agreed", INT),
    col("answered_utc", TEXT),
    zero_or_one("agreed"),
)

assignment = table(
    "assignment",
    key("participant_id", TEXT, parent("participant.participant_id")),
    col("algorithm", TEXT),
    col("list_no", INT),
    col("seed", TEXT),
    col("order_sha256", TEXT),
)

# Lists are handed out by number and keep it; a list whose participant is erased is free again.
list_slot = table(
    "list_slot",
    key("study_id", TEXT, ForeignKey("study.study_id")),
    Column("cell", TEXT, primary_key=True, nullable=False, server_default=""),
    key("list_no", INT),
    col(
        "participant_id",
        TEXT,
        ForeignKey("participant.participant_id", ondelete="SET NULL"),
        null=True,
    ),
    col("reserved_utc", TEXT),
)

session = table(
    "session",
    key("session_id"),
    col("participant_id", TEXT, parent("participant.participant_id")),
    col("token_sha256", TEXT, unique=True),
    col("started_utc", TEXT),
    col("last_seen_utc", TEXT),
    col("ended_utc", TEXT, null=True),
    col("app_version", TEXT),
    col("browser", TEXT),
    col("browser_version", TEXT),
    col("os", TEXT),
    col("is_mobile", INT),
    col("screen_w_px", INT),
    col("screen_h_px", INT),
    col("viewport_w_px", INT),
    col("viewport_h_px", INT),
    col("device_pixel_ratio", NUM),
    col("refresh_hz", NUM, null=True),
    col("language", TEXT),
    col("tz_offset_min", INT),
    col("css_px_per_mm", NUM, null=True),
    col("viewing_distance_mm", NUM, null=True),
    col("px_per_degree", NUM, null=True),  # device pixels
    zero_or_one("is_mobile"),
)

# One row per check of the screen; a refused one may be followed by others.
screen_check = table(
    "screen_check",
    key("check_id", INT),
    col("session_id", TEXT, parent("session.session_id")),
    col("verdict", TEXT),
    col("problems_json", TEXT),
    col("codec_plays", INT, null=True),
    col("fullscreen", INT),
    col("refresh_hz", NUM, null=True),
    col("css_px_per_mm", NUM, null=True),
    col("viewing_distance_mm", NUM, null=True),
    col("px_per_degree", NUM, null=True),
    col("calibration_skipped", INT),
    col("viewport_w_px", INT),
    col("viewport_h_px", INT),
    col("checked_utc", TEXT),
    one_of("verdict", "passed", "flagged", "refused"),
    zero_or_one("fullscreen"),
    zero_or_one("calibration_skipped"),
)

trial = table(
    "trial",
    key("trial_id", INT),
    col("participant_id", TEXT, parent("participant.participant_id")),
    col("trial_index", INT),
    col("block", INT),
    col("trial_kind", TEXT),
    col("layout", TEXT),
    # Empty while an adaptive track has not chosen the clip yet.
    col("stimulus_a", INT, ForeignKey("stimulus.stimulus_id"), null=True),
    col("stimulus_b", INT, ForeignKey("stimulus.stimulus_id"), null=True),
    col("expected_json", TEXT, null=True),
    col("answered_utc", TEXT, null=True),
    col("track", TEXT, null=True),
    UniqueConstraint("participant_id", "trial_index"),
    one_of("trial_kind", "practice", "test", "catch", "repeat"),
)

# One row per showing: a reload adds a row and never overwrites one.
presentation = table(
    "presentation",
    key("presentation_id"),
    col("trial_id", INT, parent("trial.trial_id")),
    col("session_id", TEXT, parent("session.session_id")),
    col("num_plays", INT),
    col("onset_ms", NUM, null=True),
    col("first_frame_ms", NUM, null=True),
    col("ended_ms", NUM, null=True),
    col("frames_total", INT, null=True),
    col("frames_dropped", INT, null=True),
    col("stall_count", INT),
    col("stall_ms", NUM),
    col("hidden_ms", NUM),
    col("fullscreen", INT),
    col("displayed_w_px", NUM),
    col("displayed_h_px", NUM),
    col("completed", INT),
    col("received_utc", TEXT),
    col("device_pixel_ratio", NUM, null=True),
    col("scale", INT, null=True),  # device pixels per pixel of the clip
    col("num_mark_plays", INT, server_default="0"),
    col("blur_count", INT, server_default="0"),
    col("fullscreen_exits", INT, server_default="0"),
    col("start_skew_ms", NUM, null=True),
    zero_or_one("fullscreen"),
    zero_or_one("completed"),
)

# What the screen did with each clip of a showing, in the order shown.
presentation_clip = table(
    "presentation_clip",
    key("presentation_id", TEXT, parent("presentation.presentation_id")),
    key("position", INT),
    col("stimulus_id", INT, ForeignKey("stimulus.stimulus_id")),
    col("num_plays", INT),
    col("onset_ms", NUM, null=True),
    col("first_frame_ms", NUM, null=True),
    col("ended_ms", NUM, null=True),
    col("frames_total", INT, null=True),
    col("frames_dropped", INT, null=True),
    col("stall_count", INT),
    col("stall_ms", NUM),
)

response = table(
    "response",
    key("response_id", INT),
    col("presentation_id", TEXT, parent("presentation.presentation_id")),
    col("trial_id", INT, parent("trial.trial_id")),
    col("question_id", INT, ForeignKey("question.question_id")),
    col("value", NUM, null=True),
    col("value_text", TEXT, null=True),
    col("rt_ms", NUM),
    col("rt_origin", TEXT),
    col("first_touch_ms", NUM, null=True),
    col("num_changes", INT),
    col("answered_utc", TEXT),
    col("item", TEXT, server_default=""),  # part of a question with several
    col("rt_onset_ms", NUM, null=True),
    col("reversed", INT, server_default="0"),
    UniqueConstraint("trial_id", "question_id", "item"),
    one_of("rt_origin", "video_onset", "video_end", "form_shown"),
    CheckConstraint("value IS NOT NULL OR value_text IS NOT NULL", name="value"),
)

# Answers to the questions at the end of the session.
session_answer = table(
    "session_answer",
    key("answer_id", INT),
    col("participant_id", TEXT, parent("participant.participant_id")),
    col("session_id", TEXT, parent("session.session_id")),
    col("question_id", INT, ForeignKey("question.question_id")),
    col("item", TEXT),
    col("value", NUM, null=True),
    col("value_text", TEXT, null=True),
    col("rt_ms", NUM),
    col("num_changes", INT),
    col("reversed", INT),
    col("answered_utc", TEXT),
    UniqueConstraint("participant_id", "question_id", "item"),
    CheckConstraint("value IS NOT NULL OR value_text IS NOT NULL", name="value"),
)

comment = table(
    "comment",
    key("comment_id", INT),
    col("presentation_id", TEXT, parent("presentation.presentation_id")),
    col("trial_id", INT, parent("trial.trial_id")),
    col("question_id", INT, ForeignKey("question.question_id")),
    col("body", TEXT),
    col("rt_ms", NUM),
    col("redacted", INT, server_default="0"),
    col("answered_utc", TEXT),
    UniqueConstraint("trial_id", "question_id"),
    CheckConstraint("length(body) <= 2000", name="body"),
    zero_or_one("redacted"),
)

event = table(
    "event",
    key("session_id", TEXT, parent("session.session_id")),
    key("seq", INT),
    col("presentation_id", TEXT, null=True),
    col("kind", TEXT),
    col("t_ms", NUM),
    col("detail_json", TEXT, null=True),
)

# The raw body of every accepted POST, written in the same transaction as its rows.
submission = table(
    "submission",
    key("submission_id"),
    col("session_id", TEXT, parent("session.session_id")),
    col("kind", TEXT),
    col("outcome", TEXT),
    col("body", TEXT),
    col("body_sha256", TEXT),
    col("received_utc", TEXT),
    one_of("outcome", "stored", "already_answered"),
)

erasure = table(
    "erasure",
    key("erasure_id", INT),
    col("study_id", TEXT, ForeignKey("study.study_id")),
    col("erased_utc", TEXT),
    col("num_rows", INT),
    col("reason", TEXT),
)

admin_audit = table(
    "admin_audit",
    key("audit_id", INT),
    col("at_utc", TEXT),
    col("action", TEXT),
    col("detail_json", TEXT),
    col("actor", TEXT, server_default="command line"),
)

admin_account = table(
    "admin_account",
    key("name"),
    col("password_hash", TEXT),
    col("created_utc", TEXT),
)

# Every difference between what was frozen and what a live study was served with.
deviation = table(
    "deviation",
    key("deviation_id", INT),
    col("at_utc", TEXT),
    col("what", TEXT),
    col("frozen_sha256", TEXT),
    col("seen_sha256", TEXT),
    col("outcome", TEXT),  # refused | accepted
)

# One row that readiness checks overwrite: proof that a write reaches the disk.
heartbeat = table("heartbeat", key("heartbeat_id", INT), col("at_utc", TEXT))

Index("trial_by_participant", trial.c.participant_id, trial.c.trial_index)
Index("presentation_by_trial", presentation.c.trial_id)
Index("presentation_by_session", presentation.c.session_id)
Index("response_by_presentation", response.c.presentation_id)
Index("comment_by_presentation", comment.c.presentation_id)
Index("submission_by_session", submission.c.session_id)
Index("session_by_participant", session.c.participant_id)
Index("screen_check_by_session", screen_check.c.session_id)
