# SPDX-License-Identifier: MIT
"""The answer of GET /api/study: all that the page needs to know of a study, in one language."""

from __future__ import annotations

from typing import Any

from sqlalchemy import Connection, select

from verisim.study.server import tables
from verisim.study.server.database import utc_now
from verisim.study.server.lists import is_full
from verisim.study.server.open_study import OpenStudy
from verisim.study.server.position import describe_clip
from verisim.study.server.questions import Question
from verisim.study.server.questions.words import language_name
from verisim.study.server.screen_check import clip_px
from verisim.study.server.study_file import Study

SIMULATED_NOTICE = (
    "This server is run for scripted raters. Answers that carry its key are marked as simulated."
)
CODEC = 'video/mp4; codecs="avc1.640028"'


def describe_study(
    connection: Connection,
    opened: OpenStudy,
    wanted: str,
    *,
    mode: str,
    kiosk: bool,
    is_simulating: bool,
) -> dict[str, Any]:
    """Returns the study in the wanted language, else in its first."""
    study = opened.study
    language = wanted if wanted in study.languages else study.languages[0]
    consent = study.consent[language]
    num_trials, num_practice, minutes = opened.size
    state = connection.scalar(select(tables.study.c.state))
    if state == "open" and is_full(connection, opened, utc_now()):
        state = "full"
    return {
        "name": study.name,
        "title": study.title[language],
        "languages": study.languages,
        "language": language,
        "language_names": {code: language_name(code) for code in study.languages},
        "state": state,
        "mode": mode,
        "kiosk": kiosk,
        "consent": {"version": consent.version, "sha256": consent.sha256, "html": consent.html},
        "instructions_html": study.instructions[language].html,
        "thanks_html": study.thanks[language].html,
        "simulated_notice": SIMULATED_NOTICE if is_simulating else None,
        "num_trials": num_trials,
        "num_practice": num_practice,
        "minutes": minutes,
        "can_stop": study.completion.partial is not None,
        "practice_feedback": study.practice.feedback,
        "trial": {
            "layout": study.trial.layout,
            "layouts": study.trial.layouts,
            "lock": study.trial.lock,
            "replays": study.trial.replays,
            "fixation_ms": study.trial.fixation_ms,
            "grey_ms": study.trial.grey_ms,
            "gap_ms": study.trial.gap_ms,
            "rest_every": study.trial.rest_every,
            "rest_min_s": study.trial.rest_min_s,
        },
        "screen": describe_screen(opened, study),
        "questions": [describe_question(q, language) for q in study.questions],
        "end_questions": [describe_question(q, language) for q in study.end_questions],
    }


def describe_question(question: Question, language: str) -> dict[str, Any]:
    return {
        "key": question.key,
        "kind": question.kind,
        "prompt": question.prompt[language],
        "optional": question.optional,
        **question.page_fields(language),
    }


def describe_screen(opened: OpenStudy, study: Study) -> dict[str, Any] | None:
    rules = study.screen
    if rules is None:
        return None
    stimuli = opened.stimulus_set.stimuli
    across = 2 if "side_by_side" in study.trial.layouts else 1
    probe = min(stimuli, key=lambda s: s.num_bytes)
    distance = rules.distance_mm
    return {
        "phone": rules.phone,
        "min_viewport": rules.min_viewport_px,  # CSS px, beside what the clips need
        "clip_px": clip_px(stimuli, across),
        "refresh": rules.refresh,
        "frame_rates_hz": sorted({s.frame_rate_hz for s in stimuli}),
        "codec": {"mime": CODEC, "probe": describe_clip(probe)} if rules.codec else None,
        "fullscreen": rules.fullscreen,
        "calibration": rules.calibration,
        "distance_mm": None
        if distance is None
        else {"usual": distance[1], "min": distance[0], "max": distance[2]},
        "px_per_degree": rules.px_per_degree,
    }
