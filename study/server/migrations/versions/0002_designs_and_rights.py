# SPDX-License-Identifier: MIT
"""Pairs, adaptive tracks, items, screen checks, session-end answers, links, freezing, accounts."""

import re
import secrets
from collections.abc import Callable
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"

INT = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
NUM: sa.types.TypeEngine[float] = sa.Double().with_variant(sa.REAL(), "sqlite")
TEXT = sa.Text()

STATES = (
    "'enrolled', 'consented', 'active', 'completed', 'declined', 'withdrawn', 'screened_out', "
    "'stopped'"
)


def upgrade() -> None:
    if op.get_bind().dialect.name == "sqlite":
        loosen_sqlite()
    else:
        loosen_postgresql()
    add_columns()
    add_tables()
    keys = sa.text("UPDATE study SET withdraw_key = :key")
    op.get_bind().execute(keys, {"key": secrets.token_hex(32)})


def loosen_sqlite() -> None:
    """SQLite cannot alter a constraint: the tables are written anew, as its manual describes."""
    bind = op.get_bind()
    triggers = bind.execute(
        sa.text("SELECT name, sql FROM sqlite_master WHERE type = 'trigger'")
    ).all()
    for name, _ in triggers:
        op.execute(f"DROP TRIGGER {name}")
    rebuild("study", lambda sql: sql.replace("'open', 'closed'", "'open', 'paused', 'closed'"))
    rebuild("participant", lambda sql: re.sub(r"state IN \([^)]*\)", f"state IN ({STATES})", sql))
    rebuild("trial", lambda sql: re.sub(r"(stimulus_a\"? INTEGER) NOT NULL", r"\1", sql))
    rebuild(
        "response",
        lambda sql: sql.replace(
            "CONSTRAINT uq_response_trial_id_question_id UNIQUE (trial_id, question_id)",
            "CONSTRAINT uq_response_trial_id_question_id_item UNIQUE (trial_id, question_id, item)",
        ),
        "item TEXT DEFAULT '' NOT NULL",
    )
    rebuild(
        "list_slot",
        lambda sql: sql.replace("(study_id, list_no)", "(study_id, cell, list_no)"),
        "cell TEXT DEFAULT '' NOT NULL",
    )
    for _, sql in triggers:
        op.execute(sa.text(sql.replace(":", r"\:")))


def rebuild(table: str, edit: Callable[[str], str], new_column: str = "") -> None:
    """Writes a table anew under edited SQL, with its rows and indexes."""
    bind = op.get_bind()
    of_table = {"table": table}
    sql = bind.scalar(sa.text("SELECT sql FROM sqlite_master WHERE name = :table"), of_table)
    edited = edit(sql)
    if new_column:
        first = edited.index("CONSTRAINT")
        edited = f"{edited[:first]}{new_column}, {edited[first:]}"
    if edited == sql:
        raise RuntimeError(f"the table {table} is not as the first migration left it")
    columns = ", ".join(row[1] for row in bind.execute(sa.text(f"PRAGMA table_info({table})")))
    indexes = bind.scalars(
        sa.text(
            "SELECT sql FROM sqlite_master"
            " WHERE type = 'index' AND tbl_name = :table AND sql IS NOT NULL"
        ),
        of_table,
    ).all()
    op.execute(re.sub(rf"CREATE TABLE \"?{table}\"?", f"CREATE TABLE {table}_new", edited, count=1))
    op.execute(f"INSERT INTO {table}_new ({columns}) SELECT {columns} FROM {table}")
    op.execute(f"DROP TABLE {table}")
    op.execute(f"ALTER TABLE {table}_new RENAME TO {table}")
    for index in indexes:
        op.execute(index)


def loosen_postgresql() -> None:
    op.drop_constraint("ck_study_state", "study")
    op.create_check_constraint("ck_study_state", "study", "state IN ('open', 'paused', 'closed')")
    op.drop_constraint("ck_participant_state", "participant")
    op.create_check_constraint("ck_participant_state", "participant", f"state IN ({STATES})")
    op.alter_column("trial", "stimulus_a", nullable=True)
    op.add_column("response", sa.Column("item", TEXT, server_default="", nullable=False))
    op.drop_constraint("uq_response_trial_id_question_id", "response")
    op.create_unique_constraint(
        "uq_response_trial_id_question_id_item", "response", ["trial_id", "question_id", "item"]
    )
    op.add_column("list_slot", sa.Column("cell", TEXT, server_default="", nullable=False))
    op.drop_constraint("pk_list_slot", "list_slot")
    op.create_primary_key("pk_list_slot", "list_slot", ["study_id", "cell", "list_no"])


def add_columns() -> None:
    def add(table: str, name: str, kind: Any, default: str | None = None) -> None:
        null = default is None
        op.add_column(table, sa.Column(name, kind, server_default=default, nullable=null))

    add("study", "mode", TEXT, "open")
    add("study", "withdraw_key", TEXT, "")
    add("study", "frozen_json", TEXT)
    add("question", "place", TEXT, "trial")
    add("participant", "cell", TEXT, "")
    add("participant", "buttons", TEXT, "normal")
    add("participant", "invitation_id", INT)
    add("participant_link", "external_study", TEXT)
    add("participant_link", "external_session", TEXT)
    for name in ("css_px_per_mm", "viewing_distance_mm", "px_per_degree"):
        add("session", name, NUM)
    add("trial", "track", TEXT)
    add("presentation", "device_pixel_ratio", NUM)
    add("presentation", "scale", INT)
    for name in ("num_mark_plays", "blur_count", "fullscreen_exits"):
        add("presentation", name, INT, "0")
    add("presentation", "start_skew_ms", NUM)
    add("response", "rt_onset_ms", NUM)
    add("response", "reversed", INT, "0")
    add("admin_audit", "actor", TEXT, "command line")


def add_tables() -> None:
    make(
        "invitation",
        col("invitation_id", INT),
        col("token_sha256", TEXT),
        col("label", TEXT),
        col("source", TEXT),
        col("max_uses", INT, null=True),
        col("num_uses", INT),
        col("state", TEXT),
        col("created_utc", TEXT),
        sa.CheckConstraint("source IN ('lab', 'link', 'pilot')", name=op.f("ck_invitation_source")),
        sa.CheckConstraint("state IN ('open', 'closed')", name=op.f("ck_invitation_state")),
        sa.PrimaryKeyConstraint("invitation_id", name=op.f("pk_invitation")),
        sa.UniqueConstraint("token_sha256", name=op.f("uq_invitation_token_sha256")),
    )
    make(
        "screen_check",
        col("check_id", INT),
        col("session_id", TEXT),
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
        sa.CheckConstraint(
            "verdict IN ('passed', 'flagged', 'refused')", name=op.f("ck_screen_check_verdict")
        ),
        sa.CheckConstraint("fullscreen IN (0, 1)", name=op.f("ck_screen_check_fullscreen")),
        sa.CheckConstraint(
            "calibration_skipped IN (0, 1)", name=op.f("ck_screen_check_calibration_skipped")
        ),
        child("screen_check", "session_id", "session"),
        sa.PrimaryKeyConstraint("check_id", name=op.f("pk_screen_check")),
    )
    op.create_index("screen_check_by_session", "screen_check", ["session_id"], unique=False)
    make(
        "presentation_clip",
        col("presentation_id", TEXT),
        col("position", INT),
        col("stimulus_id", INT),
        col("num_plays", INT),
        col("onset_ms", NUM, null=True),
        col("first_frame_ms", NUM, null=True),
        col("ended_ms", NUM, null=True),
        col("frames_total", INT, null=True),
        col("frames_dropped", INT, null=True),
        col("stall_count", INT),
        col("stall_ms", NUM),
        child("presentation_clip", "presentation_id", "presentation"),
        sa.ForeignKeyConstraint(
            ["stimulus_id"], ["stimulus.stimulus_id"], name=op.f("fk_presentation_clip_stimulus_id")
        ),
        sa.PrimaryKeyConstraint("presentation_id", "position", name=op.f("pk_presentation_clip")),
    )
    make(
        "session_answer",
        col("answer_id", INT),
        col("participant_id", TEXT),
        col("session_id", TEXT),
        col("question_id", INT),
        col("item", TEXT),
        col("value", NUM, null=True),
        col("value_text", TEXT, null=True),
        col("rt_ms", NUM),
        col("num_changes", INT),
        col("reversed", INT),
        col("answered_utc", TEXT),
        sa.CheckConstraint(
            "value IS NOT NULL OR value_text IS NOT NULL", name=op.f("ck_session_answer_value")
        ),
        child("session_answer", "participant_id", "participant"),
        child("session_answer", "session_id", "session"),
        sa.ForeignKeyConstraint(
            ["question_id"], ["question.question_id"], name=op.f("fk_session_answer_question_id")
        ),
        sa.PrimaryKeyConstraint("answer_id", name=op.f("pk_session_answer")),
        sa.UniqueConstraint(
            "participant_id",
            "question_id",
            "item",
            name=op.f("uq_session_answer_participant_id_question_id_item"),
        ),
    )
    make(
        "admin_account",
        col("name", TEXT),
        col("password_hash", TEXT),
        col("created_utc", TEXT),
        sa.PrimaryKeyConstraint("name", name=op.f("pk_admin_account")),
    )
    make(
        "deviation",
        col("deviation_id", INT),
        col("at_utc", TEXT),
        col("what", TEXT),
        col("frozen_sha256", TEXT),
        col("seen_sha256", TEXT),
        col("outcome", TEXT),
        sa.PrimaryKeyConstraint("deviation_id", name=op.f("pk_deviation")),
    )


def col(name: str, kind: Any, *, null: bool = False) -> Any:
    return sa.Column(name, kind, nullable=null)


def child(table: str, column: str, of: str) -> sa.ForeignKeyConstraint:
    name = op.f(f"fk_{table}_{column}")
    return sa.ForeignKeyConstraint([column], [f"{of}.{column}"], name=name, ondelete="CASCADE")


def make(table: str, *parts: sa.schema.SchemaItem) -> None:
    op.create_table(table, *parts, sqlite_strict=True)
