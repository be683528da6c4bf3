# SPDX-License-Identifier: MIT
"""The codebook: every column that an export may hold, with unit, meaning and levels."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Column:
    description: str
    unit: str = ""
    levels: dict[str, str] = field(default_factory=dict)  # value → meaning


YES_NO = {"0": "no", "1": "yes"}
PEOPLE = {
    "lab": "came to a laboratory",
    "link": "followed an open link",
    "prolific": "came through Prolific",
    "mturk": "came through Mechanical Turk",
    "pilot": "a try-out before the study opened",
    "simulated": "a scripted rater, not a person",
}
RTS = {
    "video_end": "end of the first full play",
    "video_onset": "first frame of the first play",
    "form_shown": "the moment the question appeared",
}
LAYOUTS = {
    "single": "one clip",
    "sequential": "two clips, one after the other",
    "side_by_side": "two clips beside each other, started together",
}
PROCESS_CPU = "CPU seconds of physics per simulated second, measured serially: "

COLUMNS: dict[str, Column] = {
    "study": Column("Name of the study"),
    "source": Column(
        "Where the row comes from", levels={**PEOPLE, "stimulus": "a property of a clip"}
    ),
    # people and visits
    "participant_id": Column("Random name of a participant; links rows, identifies nobody"),
    "session_id": Column("Random name of one visit"),
    "state": Column(
        "How far the participant came",
        levels={
            "enrolled": "opened the page",
            "consented": "agreed to the consent form",
            "active": "began the trials",
            "completed": "answered every trial",
            "declined": "did not agree",
            "withdrawn": "took the agreement back",
            "screened_out": "the screen did not fit",
            "stopped": "ended early; the answers are kept",
        },
    ),
    "consent_version": Column("Version of the consent form that was answered"),
    "consent_sha256": Column("SHA-256 of the consent form's text as shown"),
    "consent_language": Column("Language of the consent form"),
    "enrolled_utc": Column("When the page was opened", "ISO 8601, UTC"),
    "consented_utc": Column("When the consent form was agreed to", "ISO 8601, UTC"),
    "completed_utc": Column("When the last answer was stored", "ISO 8601, UTC"),
    "num_trials_planned": Column("Trials in the participant's order, practice included", "count"),
    "num_trials_answered": Column("Trials that were answered, practice included", "count"),
    "cell": Column("Level of the factor that varies between participants; empty: none does"),
    "buttons": Column(
        "Order of the options of yes/no and category questions",
        levels={"normal": "as the study file lists them", "reversed": "the other way round"},
    ),
    "list_no": Column("Number of the order within the cell, from 0", "index"),
    "order_algorithm": Column("Sampler that made the order"),
    "order_seed": Column("Seed of the participant's order, which it reproduces"),
    "order_sha256": Column("SHA-256 of the order, one line `kind TAB stimulus` per trial"),
    "started_utc": Column("When the visit began", "ISO 8601, UTC"),
    "last_seen_utc": Column("When the visit last sent something", "ISO 8601, UTC"),
    "ended_utc": Column("When the visit ended by the last step", "ISO 8601, UTC"),
    "app_version": Column("Version of the study page"),
    "browser": Column("Browser, as it names itself"),
    "browser_version": Column("Version of the browser"),
    "os": Column("Operating system, as the browser names it"),
    "is_mobile": Column("Whether the browser calls itself mobile", levels=YES_NO),
    "screen_w_px": Column("Width of the screen", "CSS px"),
    "screen_h_px": Column("Height of the screen", "CSS px"),
    "viewport_w_px": Column("Width of the page's window at the start", "CSS px"),
    "viewport_h_px": Column("Height of the page's window at the start", "CSS px"),
    "device_pixel_ratio": Column("Device pixels per CSS pixel", "1"),
    "refresh_hz": Column("Refresh rate of the screen, estimated by the page", "Hz"),
    "language": Column("Language the browser asks for"),
    "tz_offset_min": Column("Minutes to add to local time to get UTC", "min"),
    "css_px_per_mm": Column("CSS pixels per millimetre, measured with a card", "px/mm"),
    "viewing_distance_mm": Column("Distance from the screen, as stated", "mm"),
    "px_per_degree": Column("Device pixels per degree of visual angle", "px/degree"),
    "screen_verdict": Column(
        "Outcome of the last check of the screen; empty: none was asked for",
        levels={
            "passed": "fits",
            "flagged": "shown all the same; see screen_problems",
            "refused": "does not fit",
        },
    ),
    "screen_problems": Column("What did not fit, codes separated by spaces"),
    # showings
    "presentation_id": Column(
        "Random name of one showing of a trial's clip; of an event: empty where the "
        "page's report of the showing never arrived"
    ),
    "block": Column("Run of trials between rests; 0 is practice", "index"),
    "trial_index": Column("Place in the participant's order, from 0", "index"),
    "trial_kind": Column(
        "What the trial is for",
        levels={
            "practice": "to get used to the task; not analysed",
            "test": "to be analysed",
            "catch": "a blatant fault, to see whether somebody watches",
            "repeat": "a test clip shown again",
        },
    ),
    "layout": Column("How clips are laid out", levels=LAYOUTS),
    "completed": Column("Whether the clip was played to its end", levels=YES_NO),
    "num_plays": Column("How often the clip was started in this showing", "count"),
    "onset_ms": Column("First frame of the first play, on the page's clock", "ms"),
    "first_frame_ms": Column("From the call to play to that frame", "ms"),
    "ended_ms": Column("End of the first full play, on the page's clock", "ms"),
    "frames_total": Column("Frames decoded over all plays", "count"),
    "frames_dropped": Column("Frames decoded but never shown", "count"),
    "stall_count": Column("How often playing waited for data", "count"),
    "stall_ms": Column("How long playing waited for data", "ms"),
    "hidden_ms": Column("How long the page was out of sight while the clip played", "ms"),
    "fullscreen": Column("Whether the page filled the screen", levels=YES_NO),
    "displayed_w_px": Column("Width of the clip on the screen", "device px"),
    "displayed_h_px": Column("Height of the clip on the screen", "device px"),
    "scale": Column("Device pixels per pixel of the clip, along one side", "1"),
    "num_mark_plays": Column("Plays for marking where it looked wrong", "count"),
    "blur_count": Column("How often the window lost the focus", "count"),
    "fullscreen_exits": Column("How often the full screen was left", "count"),
    "start_skew_ms": Column("Second clip's first frame less the first one's, side by side", "ms"),
    "track": Column("Adaptive track that chose the clip; empty: none"),
    "position": Column("Place of the clip as shown: 0 first or left, 1 second or right", "index"),
    "planned_position": Column("Place of the clip as planned", "index"),
    # answers
    "item": Column("Part of a question that has several; empty: the question has one"),
    "correct": Column("Whether the answer is the expected one; empty: none is", levels=YES_NO),
    "rt_onset_ms": Column("Time from the first frame to the answer", "ms"),
    "num_changes": Column("How often the answer was changed before it was sent", "count"),
    "reversed": Column("Whether the options stood in reverse order", levels=YES_NO),
    "question": Column("Key of the question"),
    "question_kind": Column("Kind of the question"),
    "value": Column("The answer as a number; its meaning depends on the question"),
    "value_text": Column("The answer as text, where it is no number"),
    "rt_ms": Column("Time from rt_origin to the answer", "ms"),
    "rt_origin": Column("What rt_ms counts from", levels=RTS),
    "answered_utc": Column("When the answer was stored", "ISO 8601, UTC"),
    "comment": Column(
        "Free text; a leading = + - @ has an apostrophe put before it; [redacted] where the "
        "researcher took the words out"
    ),
    # clips
    "stimulus": Column("Name of the clip shown"),
    "stimulus_sha256": Column("SHA-256 of the clip's file"),
    "stimulus_b": Column("Name of the second clip of a pair"),
    "stimulus_b_sha256": Column("SHA-256 of the second clip's file"),
    "scene": Column("Name of the simulated scene"),
    "method": Column("Simulation method"),
    "role": Column(
        "What the clip is for",
        levels={"test": "to be rated", "practice": "to get used to", "catch": "a blatant fault"},
    ),
    "seed": Column("Seed of the scene"),
    "reference": Column("Name of the clip of the reference level; empty: this is one, or none"),
    "sha256": Column("SHA-256 of the clip's file"),
    "num_bytes": Column("Size of the clip's file", "byte"),
    "width_px": Column("Width of the clip", "px"),
    "height_px": Column("Height of the clip", "px"),
    "frame_rate_hz": Column("Frames per second of the clip", "Hz"),
    "num_frames": Column("Frames in the clip", "count"),
    "duration_s": Column("Length of the clip", "s"),
    "content_key": Column("Hash of all that decides the clip's content"),
    # the engine's account of the clip
    "engine_version": Column("Version of the simulation engine"),
    "scene_sha256": Column("SHA-256 of the scene file"),
    "state_hash": Column("Hash of the simulation's final state"),
    "failed_code": Column("Why the run failed; empty: it did not"),
    "failed_body": Column("Body that failed first"),
    "failed_time_s": Column("When it failed, in simulated time", "s"),
    "dt_s": Column("Smallest time step used", "s"),
    "stiffness_n_m": Column("Contact stiffness", "N/m"),
    "particle_size_m": Column("Particle size", "m"),
    "damping_ratio": Column("Damping over critical damping", "1"),
    "max_penetration_m": Column("Deepest overlap during the run", "m"),
    "mean_penetration_m": Column("Mean overlap over contacts and time", "m"),
    "energy_residual_rel": Column("Energy not accounted for, over the energy scale", "1"),
    "momentum_residual_rel": Column("Momentum not accounted for, over the impulses", "1"),
    "num_particles": Column("Particles of all bodies", "count"),
    "max_contacts": Column("Most contacts at one time", "count"),
    "error_to_reference_m": Column(
        "Root mean square distance of the centres of mass to the reference level's run", "m"
    ),
    "cost_machine": Column("Machine on which cost was measured; empty: not measured"),
    "cost_build": Column("Build with which cost was measured"),
    "cost_num_runs": Column("Runs behind the cost", "count"),
    "cpu_s_per_sim_s_median": Column(PROCESS_CPU + "median", "s/s"),
    "cpu_s_per_sim_s_min": Column(PROCESS_CPU + "minimum", "s/s"),
    "cpu_s_per_sim_s_q1": Column(PROCESS_CPU + "first quartile", "s/s"),
    "cpu_s_per_sim_s_q3": Column(PROCESS_CPU + "third quartile", "s/s"),
    # events and exclusions
    "seq": Column("Number of the event within the visit", "index"),
    "kind": Column("What happened on the page"),
    "t_ms": Column("When, on the page's clock", "ms"),
    "detail": Column("More about it, as JSON"),
    "rule": Column(
        "Exclusion rule, fixed in the study file before it opened",
        levels={
            "missed_catch": "catch trials that were answered wrongly (a rating: not below the "
            "middle of its scale); flagged when value >= limit",
            "equal_answers_run": "longest run of one answer to the primary question; flagged when "
            "value >= limit",
            "frames_dropped_share": "share of frames never shown; flagged when value > limit",
            "hidden_ms": "time out of sight while clips played; flagged when value > limit",
            "median_rt_below_ms": "median response time of test trials; flagged when value < limit",
        },
    ),
    "limit": Column("The rule's limit"),
    "flagged": Column("Whether the rule applies; flagged rows stay in all tables", levels=YES_NO),
}

# Cells of these columns are the same text for everybody with the same clip, so blinding hides them.
BLINDED_NAMES = ("stimulus", "stimulus_b", "reference", "method", "cell")
BLINDED_HASHES = ("stimulus_sha256", "stimulus_b_sha256", "sha256", "content_key", "state_hash")


def describe(name: str) -> Column:
    """Returns a column's codebook entry; a factor of the set is described by its name."""
    if name.startswith("factor_"):
        return Column(f"Level of the factor {name.removeprefix('factor_')!r} of the clip shown")
    return COLUMNS[name]
