# SPDX-License-Identifier: MIT
"""The first tables: study, stimuli, participants, trials, showings, answers, and the raw log."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None

INT = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
NUM: sa.types.TypeEngine[float] = sa.Double().with_variant(sa.REAL(), "sqlite")

# An answer is final: it goes only with its participant, whose row is deleted first.
FINAL = """
CREATE TRIGGER {table}_is_never_changed BEFORE UPDATE ON {table}
BEGIN SELECT RAISE(ABORT, '{table} rows are never changed'); END
"""
KEPT = """
CREATE TRIGGER {table}_goes_only_with_participant BEFORE DELETE ON {table}
WHEN EXISTS (
  SELECT 1 FROM {via} JOIN participant USING (participant_id) WHERE {via}_id = OLD.{via}_id
)
BEGIN SELECT RAISE(ABORT, '{table} rows go only with their participant'); END
"""
# The same two rules in PostgreSQL's words.
FINAL_POSTGRESQL = """
CREATE FUNCTION {table}_never_changes() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN RAISE EXCEPTION '{table} rows are never changed'; END $$;
CREATE TRIGGER {table}_is_never_changed BEFORE UPDATE ON {table}
FOR EACH ROW EXECUTE FUNCTION {table}_never_changes()
"""
KEPT_POSTGRESQL = """
CREATE FUNCTION {table}_goes_with_participant() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  IF EXISTS (
    SELECT 1 FROM {via} JOIN participant USING (participant_id) WHERE {via}_id = OLD.{via}_id
  ) THEN RAISE EXCEPTION '{table} rows go only with their participant'; END IF;
  RETURN OLD;
END $$;
CREATE TRIGGER {table}_goes_only_with_participant BEFORE DELETE ON {table}
FOR EACH ROW EXECUTE FUNCTION {table}_goes_with_participant()
"""


def upgrade() -> None:
    op.create_table(
        "admin_audit",
        sa.Column("audit_id", INT, nullable=False),
        sa.Column("at_utc", sa.Text(), nullable=False),
        sa.Column("action", sa.Text(), nullable=False),
        sa.Column("detail_json", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("audit_id", name=op.f("pk_admin_audit")),
        sqlite_strict=True,
    )
    op.create_table(
        "heartbeat",
        sa.Column("heartbeat_id", INT, nullable=False),
        sa.Column("at_utc", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("heartbeat_id", name=op.f("pk_heartbeat")),
        sqlite_strict=True,
    )
    op.create_table(
        "stimulus",
        sa.Column("stimulus_id", INT, nullable=False),
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("sha256", sa.Text(), nullable=False),
        sa.Column("scene", sa.Text(), nullable=False),
        sa.Column("method", sa.Text(), nullable=False),
        sa.Column("seed", INT, nullable=True),
        sa.Column("reference", sa.Text(), nullable=False),
        sa.Column("file", sa.Text(), nullable=False),
        sa.Column("num_bytes", INT, nullable=False),
        sa.Column("width_px", INT, nullable=False),
        sa.Column("height_px", INT, nullable=False),
        sa.Column("frame_rate_hz", NUM, nullable=False),
        sa.Column("num_frames", INT, nullable=False),
        sa.Column("duration_s", NUM, nullable=False),
        sa.Column("content_key", sa.Text(), nullable=False),
        sa.Column("provenance_json", sa.Text(), nullable=False),
        sa.CheckConstraint("length(sha256) = 64", name=op.f("ck_stimulus_sha256")),
        sa.PrimaryKeyConstraint("stimulus_id", name=op.f("pk_stimulus")),
        sa.UniqueConstraint("name", name=op.f("uq_stimulus_name")),
        sqlite_strict=True,
    )
    op.create_table(
        "study",
        sa.Column("study_id", sa.Text(), nullable=False),
        sa.Column("title", sa.Text(), nullable=False),
        sa.Column("config_json", sa.Text(), nullable=False),
        sa.Column("config_sha256", sa.Text(), nullable=False),
        sa.Column("set_name", sa.Text(), nullable=False),
        sa.Column("set_dir", sa.Text(), nullable=False),
        sa.Column("set_sha256", sa.Text(), nullable=False),
        sa.Column("blind_key", sa.Text(), nullable=False),
        sa.Column("state", sa.Text(), nullable=False),
        sa.Column("created_utc", sa.Text(), nullable=False),
        sa.CheckConstraint("state IN ('open', 'closed')", name=op.f("ck_study_state")),
        sa.PrimaryKeyConstraint("study_id", name=op.f("pk_study")),
        sqlite_strict=True,
    )
    op.create_table(
        "condition",
        sa.Column("condition_id", INT, nullable=False),
        sa.Column("study_id", sa.Text(), nullable=False),
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("factors_json", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["study_id"], ["study.study_id"], name=op.f("fk_condition_study_id")
        ),
        sa.PrimaryKeyConstraint("condition_id", name=op.f("pk_condition")),
        sa.UniqueConstraint("study_id", "name", name=op.f("uq_condition_study_id_name")),
        sqlite_strict=True,
    )
    op.create_table(
        "erasure",
        sa.Column("erasure_id", INT, nullable=False),
        sa.Column("study_id", sa.Text(), nullable=False),
        sa.Column("erased_utc", sa.Text(), nullable=False),
        sa.Column("num_rows", INT, nullable=False),
        sa.Column("reason", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(["study_id"], ["study.study_id"], name=op.f("fk_erasure_study_id")),
        sa.PrimaryKeyConstraint("erasure_id", name=op.f("pk_erasure")),
        sqlite_strict=True,
    )
    op.create_table(
        "participant",
        sa.Column("participant_id", sa.Text(), nullable=False),
        sa.Column("study_id", sa.Text(), nullable=False),
        sa.Column("source", sa.Text(), nullable=False),
        sa.Column("state", sa.Text(), nullable=False),
        sa.Column("completion_code", sa.Text(), nullable=False),
        sa.Column("enrolled_utc", sa.Text(), nullable=False),
        sa.Column("completed_utc", sa.Text(), nullable=True),
        sa.CheckConstraint(
            "source IN ('lab', 'link', 'prolific', 'mturk', 'pilot', 'simulated')",
            name=op.f("ck_participant_source"),
        ),
        sa.CheckConstraint(
            "state IN ('enrolled', 'consented', 'active', 'completed', 'declined', 'withdrawn')",
            name=op.f("ck_participant_state"),
        ),
        sa.CheckConstraint(
            "length(participant_id) >= 22", name=op.f("ck_participant_participant_id")
        ),
        sa.ForeignKeyConstraint(
            ["study_id"], ["study.study_id"], name=op.f("fk_participant_study_id")
        ),
        sa.PrimaryKeyConstraint("participant_id", name=op.f("pk_participant")),
        sa.UniqueConstraint("completion_code", name=op.f("uq_participant_completion_code")),
        sqlite_strict=True,
    )
    op.create_table(
        "question",
        sa.Column("question_id", INT, nullable=False),
        sa.Column("study_id", sa.Text(), nullable=False),
        sa.Column("key", sa.Text(), nullable=False),
        sa.Column("version", INT, nullable=False),
        sa.Column("kind", sa.Text(), nullable=False),
        sa.Column("optional", INT, nullable=False),
        sa.Column("scale_min", NUM, nullable=True),
        sa.Column("scale_max", NUM, nullable=True),
        sa.Column("scale_step", NUM, nullable=True),
        sa.Column("prompt_json", sa.Text(), nullable=False),
        sa.Column("meaning_json", sa.Text(), nullable=False),
        sa.CheckConstraint("optional IN (0, 1)", name=op.f("ck_question_optional")),
        sa.ForeignKeyConstraint(
            ["study_id"], ["study.study_id"], name=op.f("fk_question_study_id")
        ),
        sa.PrimaryKeyConstraint("question_id", name=op.f("pk_question")),
        sa.UniqueConstraint(
            "study_id", "key", "version", name=op.f("uq_question_study_id_key_version")
        ),
        sqlite_strict=True,
    )
    op.create_table(
        "assignment",
        sa.Column("participant_id", sa.Text(), nullable=False),
        sa.Column("algorithm", sa.Text(), nullable=False),
        sa.Column("list_no", INT, nullable=False),
        sa.Column("seed", sa.Text(), nullable=False),
        sa.Column("order_sha256", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["participant_id"],
            ["participant.participant_id"],
            name=op.f("fk_assignment_participant_id"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("participant_id", name=op.f("pk_assignment")),
        sqlite_strict=True,
    )
    op.create_table(
        "consent",
        sa.Column("consent_id", INT, nullable=False),
        sa.Column("participant_id", sa.Text(), nullable=False),
        sa.Column("form_version", sa.Text(), nullable=False),
        sa.Column("form_sha256", sa.Text(), nullable=False),
        sa.Column("language", sa.Text(), nullable=False),
        sa.Column("agreed", INT, nullable=False),
        sa.Column("answered_utc", sa.Text(), nullable=False),
        sa.CheckConstraint("agreed IN (0, 1)", name=op.f("ck_consent_agreed")),
        sa.ForeignKeyConstraint(
            ["participant_id"],
            ["participant.participant_id"],
            name=op.f("fk_consent_participant_id"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("consent_id", name=op.f("pk_consent")),
        sa.UniqueConstraint("participant_id", name=op.f("uq_consent_participant_id")),
        sqlite_strict=True,
    )
    op.create_table(
        "list_slot",
        sa.Column("study_id", sa.Text(), nullable=False),
        sa.Column("list_no", INT, nullable=False),
        sa.Column("participant_id", sa.Text(), nullable=True),
        sa.Column("reserved_utc", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["participant_id"],
            ["participant.participant_id"],
            name=op.f("fk_list_slot_participant_id"),
            ondelete="SET NULL",
        ),
        sa.ForeignKeyConstraint(
            ["study_id"], ["study.study_id"], name=op.f("fk_list_slot_study_id")
        ),
        sa.PrimaryKeyConstraint("study_id", "list_no", name=op.f("pk_list_slot")),
        sqlite_strict=True,
    )
    op.create_table(
        "participant_link",
        sa.Column("participant_id", sa.Text(), nullable=False),
        sa.Column("platform", sa.Text(), nullable=False),
        sa.Column("external_id", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["participant_id"],
            ["participant.participant_id"],
            name=op.f("fk_participant_link_participant_id"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("participant_id", name=op.f("pk_participant_link")),
        sa.UniqueConstraint(
            "platform", "external_id", name=op.f("uq_participant_link_platform_external_id")
        ),
        sqlite_strict=True,
    )
    op.create_table(
        "session",
        sa.Column("session_id", sa.Text(), nullable=False),
        sa.Column("participant_id", sa.Text(), nullable=False),
        sa.Column("token_sha256", sa.Text(), nullable=False),
        sa.Column("started_utc", sa.Text(), nullable=False),
        sa.Column("last_seen_utc", sa.Text(), nullable=False),
        sa.Column("ended_utc", sa.Text(), nullable=True),
        sa.Column("app_version", sa.Text(), nullable=False),
        sa.Column("browser", sa.Text(), nullable=False),
        sa.Column("browser_version", sa.Text(), nullable=False),
        sa.Column("os", sa.Text(), nullable=False),
        sa.Column("is_mobile", INT, nullable=False),
        sa.Column("screen_w_px", INT, nullable=False),
        sa.Column("screen_h_px", INT, nullable=False),
        sa.Column("viewport_w_px", INT, nullable=False),
        sa.Column("viewport_h_px", INT, nullable=False),
        sa.Column("device_pixel_ratio", NUM, nullable=False),
        sa.Column("refresh_hz", NUM, nullable=True),
        sa.Column("language", sa.Text(), nullable=False),
        sa.Column("tz_offset_min", INT, nullable=False),
        sa.CheckConstraint("is_mobile IN (0, 1)", name=op.f("ck_session_is_mobile")),
        sa.ForeignKeyConstraint(
            ["participant_id"],
            ["participant.participant_id"],
            name=op.f("fk_session_participant_id"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("session_id", name=op.f("pk_session")),
        sa.UniqueConstraint("token_sha256", name=op.f("uq_session_token_sha256")),
        sqlite_strict=True,
    )
    op.create_index("session_by_participant", "session", ["participant_id"], unique=False)
    op.create_table(
        "study_stimulus",
        sa.Column("study_id", sa.Text(), nullable=False),
        sa.Column("stimulus_id", INT, nullable=False),
        sa.Column("condition_id", INT, nullable=False),
        sa.Column("role", sa.Text(), nullable=False),
        sa.CheckConstraint(
            "role IN ('test', 'practice', 'catch')", name=op.f("ck_study_stimulus_role")
        ),
        sa.ForeignKeyConstraint(
            ["condition_id"],
            ["condition.condition_id"],
            name=op.f("fk_study_stimulus_condition_id"),
        ),
        sa.ForeignKeyConstraint(
            ["stimulus_id"], ["stimulus.stimulus_id"], name=op.f("fk_study_stimulus_stimulus_id")
        ),
        sa.ForeignKeyConstraint(
            ["study_id"], ["study.study_id"], name=op.f("fk_study_stimulus_study_id")
        ),
        sa.PrimaryKeyConstraint("study_id", "stimulus_id", name=op.f("pk_study_stimulus")),
        sqlite_strict=True,
    )
    op.create_table(
        "trial",
        sa.Column("trial_id", INT, nullable=False),
        sa.Column("participant_id", sa.Text(), nullable=False),
        sa.Column("trial_index", INT, nullable=False),
        sa.Column("block", INT, nullable=False),
        sa.Column("trial_kind", sa.Text(), nullable=False),
        sa.Column("layout", sa.Text(), nullable=False),
        sa.Column("stimulus_a", INT, nullable=False),
        sa.Column("stimulus_b", INT, nullable=True),
        sa.Column("expected_json", sa.Text(), nullable=True),
        sa.Column("answered_utc", sa.Text(), nullable=True),
        sa.CheckConstraint(
            "trial_kind IN ('practice', 'test', 'catch', 'repeat')",
            name=op.f("ck_trial_trial_kind"),
        ),
        sa.ForeignKeyConstraint(
            ["participant_id"],
            ["participant.participant_id"],
            name=op.f("fk_trial_participant_id"),
            ondelete="CASCADE",
        ),
        sa.ForeignKeyConstraint(
            ["stimulus_a"], ["stimulus.stimulus_id"], name=op.f("fk_trial_stimulus_a")
        ),
        sa.ForeignKeyConstraint(
            ["stimulus_b"], ["stimulus.stimulus_id"], name=op.f("fk_trial_stimulus_b")
        ),
        sa.PrimaryKeyConstraint("trial_id", name=op.f("pk_trial")),
        sa.UniqueConstraint(
            "participant_id", "trial_index", name=op.f("uq_trial_participant_id_trial_index")
        ),
        sqlite_strict=True,
    )
    op.create_index(
        "trial_by_participant", "trial", ["participant_id", "trial_index"], unique=False
    )
    op.create_table(
        "event",
        sa.Column("session_id", sa.Text(), nullable=False),
        sa.Column("seq", INT, nullable=False),
        sa.Column("presentation_id", sa.Text(), nullable=True),
        sa.Column("kind", sa.Text(), nullable=False),
        sa.Column("t_ms", NUM, nullable=False),
        sa.Column("detail_json", sa.Text(), nullable=True),
        sa.ForeignKeyConstraint(
            ["session_id"],
            ["session.session_id"],
            name=op.f("fk_event_session_id"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("session_id", "seq", name=op.f("pk_event")),
        sqlite_strict=True,
    )
    op.create_table(
        "presentation",
        sa.Column("presentation_id", sa.Text(), nullable=False),
        sa.Column("trial_id", INT, nullable=False),
        sa.Column("session_id", sa.Text(), nullable=False),
        sa.Column("num_plays", INT, nullable=False),
        sa.Column("onset_ms", NUM, nullable=True),
        sa.Column("first_frame_ms", NUM, nullable=True),
        sa.Column("ended_ms", NUM, nullable=True),
        sa.Column("frames_total", INT, nullable=True),
        sa.Column("frames_dropped", INT, nullable=True),
        sa.Column("stall_count", INT, nullable=False),
        sa.Column("stall_ms", NUM, nullable=False),
        sa.Column("hidden_ms", NUM, nullable=False),
        sa.Column("fullscreen", INT, nullable=False),
        sa.Column("displayed_w_px", NUM, nullable=False),
        sa.Column("displayed_h_px", NUM, nullable=False),
        sa.Column("completed", INT, nullable=False),
        sa.Column("received_utc", sa.Text(), nullable=False),
        sa.CheckConstraint("completed IN (0, 1)", name=op.f("ck_presentation_completed")),
        sa.CheckConstraint("fullscreen IN (0, 1)", name=op.f("ck_presentation_fullscreen")),
        sa.ForeignKeyConstraint(
            ["session_id"],
            ["session.session_id"],
            name=op.f("fk_presentation_session_id"),
            ondelete="CASCADE",
        ),
        sa.ForeignKeyConstraint(
            ["trial_id"],
            ["trial.trial_id"],
            name=op.f("fk_presentation_trial_id"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("presentation_id", name=op.f("pk_presentation")),
        sqlite_strict=True,
    )
    op.create_index("presentation_by_session", "presentation", ["session_id"], unique=False)
    op.create_index("presentation_by_trial", "presentation", ["trial_id"], unique=False)
    op.create_table(
        "submission",
        sa.Column("submission_id", sa.Text(), nullable=False),
        sa.Column("session_id", sa.Text(), nullable=False),
        sa.Column("kind", sa.Text(), nullable=False),
        sa.Column("outcome", sa.Text(), nullable=False),
        sa.Column("body", sa.Text(), nullable=False),
        sa.Column("body_sha256", sa.Text(), nullable=False),
        sa.Column("received_utc", sa.Text(), nullable=False),
        sa.CheckConstraint(
            "outcome IN ('stored', 'already_answered')", name=op.f("ck_submission_outcome")
        ),
        sa.ForeignKeyConstraint(
            ["session_id"],
            ["session.session_id"],
            name=op.f("fk_submission_session_id"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("submission_id", name=op.f("pk_submission")),
        sqlite_strict=True,
    )
    op.create_index("submission_by_session", "submission", ["session_id"], unique=False)
    op.create_table(
        "comment",
        sa.Column("comment_id", INT, nullable=False),
        sa.Column("presentation_id", sa.Text(), nullable=False),
        sa.Column("trial_id", INT, nullable=False),
        sa.Column("question_id", INT, nullable=False),
        sa.Column("body", sa.Text(), nullable=False),
        sa.Column("rt_ms", NUM, nullable=False),
        sa.Column("redacted", INT, server_default="0", nullable=False),
        sa.Column("answered_utc", sa.Text(), nullable=False),
        sa.CheckConstraint("length(body) <= 2000", name=op.f("ck_comment_body")),
        sa.CheckConstraint("redacted IN (0, 1)", name=op.f("ck_comment_redacted")),
        sa.ForeignKeyConstraint(
            ["presentation_id"],
            ["presentation.presentation_id"],
            name=op.f("fk_comment_presentation_id"),
            ondelete="CASCADE",
        ),
        sa.ForeignKeyConstraint(
            ["question_id"], ["question.question_id"], name=op.f("fk_comment_question_id")
        ),
        sa.ForeignKeyConstraint(
            ["trial_id"], ["trial.trial_id"], name=op.f("fk_comment_trial_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("comment_id", name=op.f("pk_comment")),
        sa.UniqueConstraint(
            "trial_id", "question_id", name=op.f("uq_comment_trial_id_question_id")
        ),
        sqlite_strict=True,
    )
    op.create_index("comment_by_presentation", "comment", ["presentation_id"], unique=False)
    op.create_table(
        "response",
        sa.Column("response_id", INT, nullable=False),
        sa.Column("presentation_id", sa.Text(), nullable=False),
        sa.Column("trial_id", INT, nullable=False),
        sa.Column("question_id", INT, nullable=False),
        sa.Column("value", NUM, nullable=True),
        sa.Column("value_text", sa.Text(), nullable=True),
        sa.Column("rt_ms", NUM, nullable=False),
        sa.Column("rt_origin", sa.Text(), nullable=False),
        sa.Column("first_touch_ms", NUM, nullable=True),
        sa.Column("num_changes", INT, nullable=False),
        sa.Column("answered_utc", sa.Text(), nullable=False),
        sa.CheckConstraint(
            "rt_origin IN ('video_onset', 'video_end', 'form_shown')",
            name=op.f("ck_response_rt_origin"),
        ),
        sa.CheckConstraint(
            "value IS NOT NULL OR value_text IS NOT NULL", name=op.f("ck_response_value")
        ),
        sa.ForeignKeyConstraint(
            ["presentation_id"],
            ["presentation.presentation_id"],
            name=op.f("fk_response_presentation_id"),
            ondelete="CASCADE",
        ),
        sa.ForeignKeyConstraint(
            ["question_id"], ["question.question_id"], name=op.f("fk_response_question_id")
        ),
        sa.ForeignKeyConstraint(
            ["trial_id"], ["trial.trial_id"], name=op.f("fk_response_trial_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("response_id", name=op.f("pk_response")),
        sa.UniqueConstraint(
            "trial_id", "question_id", name=op.f("uq_response_trial_id_question_id")
        ),
        sqlite_strict=True,
    )
    op.create_index("response_by_presentation", "response", ["presentation_id"], unique=False)

    for table, via in (("response", "trial"), ("submission", "session")):
        if op.get_bind().dialect.name == "postgresql":
            op.execute(FINAL_POSTGRESQL.format(table=table))
            op.execute(KEPT_POSTGRESQL.format(table=table, via=via))
            continue
        op.execute(FINAL.format(table=table))
        op.execute(KEPT.format(table=table, via=via))
