# SPDX-License-Identifier: MIT
"""The columns of each exported table, in order. `FACTORS` stands for the factors of the set."""

from __future__ import annotations

FACTORS = "factor_*"

TABLES: dict[str, str] = {
    "ratings": (
        "study participant_id source session_id presentation_id block trial_index trial_kind layout"
        " stimulus stimulus_sha256 stimulus_b stimulus_b_sha256 scene method factor_*"
        " question question_kind item value value_text correct rt_ms rt_origin rt_onset_ms"
        " num_changes reversed track num_plays frames_dropped stall_ms hidden_ms answered_utc"
    ),
    "participants": (
        "study participant_id source state consent_version consent_sha256 consent_language"
        " enrolled_utc consented_utc completed_utc num_trials_planned num_trials_answered"
        " cell buttons list_no order_algorithm order_seed order_sha256"
    ),
    "sessions": (
        "study participant_id source session_id started_utc last_seen_utc ended_utc app_version"
        " browser browser_version os is_mobile screen_w_px screen_h_px viewport_w_px viewport_h_px"
        " device_pixel_ratio refresh_hz language tz_offset_min css_px_per_mm viewing_distance_mm"
        " px_per_degree screen_verdict screen_problems"
    ),
    "presentations": (
        "study participant_id source session_id presentation_id trial_index trial_kind block layout"
        " stimulus stimulus_sha256 stimulus_b stimulus_b_sha256 completed num_plays onset_ms"
        " first_frame_ms ended_ms frames_total frames_dropped stall_count stall_ms hidden_ms"
        " fullscreen displayed_w_px displayed_h_px device_pixel_ratio scale num_mark_plays"
        " blur_count fullscreen_exits start_skew_ms track"
    ),
    "showings": (
        "study participant_id source session_id presentation_id position planned_position"
        " stimulus stimulus_sha256 num_plays onset_ms first_frame_ms ended_ms frames_total"
        " frames_dropped stall_count stall_ms"
    ),
    "closing": (
        "study participant_id source session_id question question_kind item value value_text"
        " rt_ms num_changes reversed answered_utc"
    ),
    "remarks": "study participant_id source session_id question comment answered_utc",
    "stimuli": (
        "study source stimulus role scene method seed reference factor_* sha256 num_bytes width_px"
        " height_px frame_rate_hz num_frames duration_s content_key"
    ),
    "engine": (
        "study source stimulus method engine_version scene_sha256 state_hash failed_code"
        " failed_body failed_time_s dt_s stiffness_n_m particle_size_m damping_ratio"
        " max_penetration_m mean_penetration_m energy_residual_rel momentum_residual_rel"
        " num_particles max_contacts error_to_reference_m cost_machine cost_build cost_num_runs"
        " cpu_s_per_sim_s_median cpu_s_per_sim_s_min cpu_s_per_sim_s_q1 cpu_s_per_sim_s_q3"
    ),
    "events": "study participant_id source session_id presentation_id seq kind t_ms detail",
    "exclusions": "study participant_id source rule value limit flagged",
    "comments": (
        "study participant_id source session_id presentation_id trial_index trial_kind stimulus"
        " scene question comment answered_utc"
    ),
}


def column_names(table: str, factor_names: list[str]) -> list[str]:
    """Returns a table's columns with the factors of this set filled in."""
    names: list[str] = []
    for name in TABLES[table].split():
        names.extend(factor_names if name == FACTORS else [name])
    return names
