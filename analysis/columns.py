# SPDX-License-Identifier: MIT
"""The tables of an export: their columns, what each may hold, and which rows they point to."""

from __future__ import annotations

from dataclasses import dataclass, field

LIVE_SOURCES = ("lab", "link", "prolific", "mturk", "pilot")
SIMULATED = "simulated"
SOURCES = (*LIVE_SOURCES, SIMULATED)
STATES = (
    "enrolled",
    "consented",
    "active",
    "completed",
    "declined",
    "withdrawn",
    "screened_out",
    "stopped",
)
TRIAL_KINDS = ("practice", "test", "catch", "repeat")
ROLES = ("test", "practice", "catch")
RT_ORIGINS = ("video_end", "video_onset", "form_shown")


@dataclass(frozen=True)
class Column:
    """One column. kind: text | integer | number | flag (0/1) | utc | sha256."""

    kind: str = "text"
    filled: bool = False  # an empty cell is an error
    allowed: tuple[str, ...] = ()
    minimum: float | None = None


@dataclass(frozen=True)
class Table:
    """Columns that must be there, the key that is unique, and column -> (table, column)."""

    columns: dict[str, Column]
    key: tuple[str, ...] = ()
    refers: dict[str, tuple[str, str]] = field(default_factory=dict)
    of_people: bool = True


ID = Column(filled=True)
TEXT = Column()
NUMBER = Column("number")
POSITIVE = Column("number", minimum=0)
COUNT = Column("integer", minimum=0)
INDEX = Column("integer", filled=True, minimum=0)
FLAG = Column("flag")
UTC = Column("utc")
SHA = Column("sha256")
SOURCE = Column(filled=True, allowed=SOURCES)
STIMULUS_SOURCE = Column(filled=True, allowed=("stimulus",))
TRIAL_KIND = Column(filled=True, allowed=TRIAL_KINDS)

PERSON = {"study": ID, "participant_id": ID, "source": SOURCE}
PERSON_REFERS = {"participant_id": ("participants", "participant_id")}
SESSION_REFERS = {**PERSON_REFERS, "session_id": ("sessions", "session_id")}
ANSWER_REFERS = {
    **SESSION_REFERS,
    "presentation_id": ("presentations", "presentation_id"),
    "stimulus": ("stimuli", "stimulus"),
}
CLIPS = {
    "layout": TEXT,
    "stimulus": ID,
    "stimulus_sha256": SHA,
    "stimulus_b": TEXT,
    "stimulus_b_sha256": SHA,
}


def _same(column: Column, names: str) -> dict[str, Column]:
    return dict.fromkeys(names.split(), column)


TABLES: dict[str, Table] = {
    "participants": Table(
        {
            **PERSON,
            "state": Column(filled=True, allowed=STATES),
            **_same(TEXT, "consent_version consent_language"),
            "consent_sha256": SHA,
            **_same(UTC, "enrolled_utc consented_utc completed_utc"),
            **_same(COUNT, "num_trials_planned num_trials_answered"),
            **_same(TEXT, "order_seed order_algorithm list_no cell buttons"),
            "order_sha256": SHA,
        },
        key=("participant_id",),
    ),
    "sessions": Table(
        {
            **PERSON,
            "session_id": ID,
            **_same(UTC, "started_utc last_seen_utc ended_utc"),
            **_same(TEXT, "app_version browser browser_version os is_mobile language"),
            **_same(POSITIVE, "screen_w_px screen_h_px viewport_w_px viewport_h_px"),
            **_same(POSITIVE, "device_pixel_ratio refresh_hz"),
            "tz_offset_min": NUMBER,
            **_same(POSITIVE, "css_px_per_mm viewing_distance_mm px_per_degree"),
            **_same(TEXT, "screen_verdict screen_problems"),
        },
        key=("session_id",),
        refers=PERSON_REFERS,
    ),
    "presentations": Table(
        {
            **PERSON,
            "session_id": ID,
            "presentation_id": ID,
            "trial_index": INDEX,
            "trial_kind": TRIAL_KIND,
            "block": TEXT,
            **CLIPS,
            "completed": FLAG,
            **_same(COUNT, "num_plays frames_total frames_dropped stall_count"),
            **_same(POSITIVE, "onset_ms first_frame_ms ended_ms stall_ms hidden_ms"),
            "fullscreen": FLAG,
            **_same(POSITIVE, "displayed_w_px displayed_h_px device_pixel_ratio"),
            **_same(COUNT, "scale num_mark_plays blur_count fullscreen_exits"),
            "start_skew_ms": NUMBER,
            "track": TEXT,
        },
        key=("presentation_id",),
        refers={**SESSION_REFERS, "stimulus": ("stimuli", "stimulus")},
    ),
    "showings": Table(
        {
            **PERSON,
            **_same(ID, "session_id presentation_id stimulus"),
            "stimulus_sha256": SHA,
            **_same(COUNT, "position planned_position num_plays frames_total frames_dropped"),
            **_same(POSITIVE, "onset_ms first_frame_ms ended_ms stall_count stall_ms"),
        },
        key=("presentation_id", "position"),
        refers=ANSWER_REFERS,
    ),
    "closing": Table(
        {
            **PERSON,
            **_same(ID, "session_id question question_kind"),
            **_same(TEXT, "item value_text"),
            "value": NUMBER,
            "rt_ms": POSITIVE,
            "num_changes": COUNT,
            "reversed": FLAG,
            "answered_utc": UTC,
        },
        key=("participant_id", "question", "item"),
        refers=SESSION_REFERS,
    ),
    "remarks": Table(
        {
            **PERSON,
            **_same(ID, "session_id question"),
            "comment": TEXT,
            "answered_utc": UTC,
        },
        key=("participant_id", "question"),
        refers=SESSION_REFERS,
    ),
    "ratings": Table(
        {
            **PERSON,
            **_same(ID, "session_id presentation_id question question_kind"),
            "block": TEXT,
            "trial_index": INDEX,
            "trial_kind": TRIAL_KIND,
            **CLIPS,
            **_same(TEXT, "scene method value_text item track"),
            **_same(FLAG, "correct reversed"),
            "value": NUMBER,
            "rt_ms": POSITIVE,
            "rt_origin": Column(allowed=RT_ORIGINS),
            **_same(COUNT, "num_plays frames_dropped"),
            **_same(POSITIVE, "stall_ms hidden_ms rt_onset_ms num_changes"),
            "answered_utc": UTC,
        },
        key=("presentation_id", "question", "item"),
        refers=ANSWER_REFERS,
    ),
    "comments": Table(
        {
            **PERSON,
            **_same(ID, "session_id presentation_id stimulus question"),
            "trial_index": INDEX,
            "trial_kind": TRIAL_KIND,
            **_same(TEXT, "scene comment"),
            "answered_utc": UTC,
        },
        key=("presentation_id", "question"),
        refers=ANSWER_REFERS,
    ),
    "events": Table(
        {
            **PERSON,
            **_same(TEXT, "session_id presentation_id detail"),
            "seq": COUNT,
            "kind": ID,
            "t_ms": NUMBER,
        },
        refers={**SESSION_REFERS, "presentation_id": ("presentations", "presentation_id")},
    ),
    "exclusions": Table(
        {
            **PERSON,
            "rule": ID,
            **_same(TEXT, "value limit"),
            "flagged": Column("flag", filled=True),
        },
        key=("participant_id", "rule"),
        refers=PERSON_REFERS,
    ),
    "stimuli": Table(
        {
            "study": ID,
            "source": STIMULUS_SOURCE,
            "stimulus": ID,
            "role": Column(filled=True, allowed=ROLES),
            **_same(TEXT, "scene method seed reference content_key"),
            "sha256": SHA,
            **_same(COUNT, "num_bytes width_px height_px num_frames"),
            **_same(POSITIVE, "frame_rate_hz duration_s"),
        },
        key=("stimulus",),
        refers={"reference": ("stimuli", "stimulus")},
        of_people=False,
    ),
    "engine": Table(
        {
            "study": ID,
            "source": STIMULUS_SOURCE,
            "stimulus": ID,
            **_same(TEXT, "method engine_version failed_code failed_body"),
            **_same(TEXT, "cost_machine cost_build"),
            **_same(SHA, "scene_sha256 state_hash"),
            **_same(POSITIVE, "failed_time_s dt_s stiffness_n_m particle_size_m damping_ratio"),
            **_same(POSITIVE, "max_penetration_m mean_penetration_m error_to_reference_m"),
            **_same(POSITIVE, "energy_residual_rel momentum_residual_rel"),
            **_same(COUNT, "num_particles max_contacts cost_num_runs"),
            **_same(POSITIVE, "cpu_s_per_sim_s_median cpu_s_per_sim_s_min"),
            **_same(POSITIVE, "cpu_s_per_sim_s_q1 cpu_s_per_sim_s_q3"),
        },
        key=("stimulus",),
        refers={"stimulus": ("stimuli", "stimulus")},
        of_people=False,
    ),
}
