# SPDX-License-Identifier: MIT
"""Brings a study and its clips into the database; the result is what the server works with."""

from __future__ import annotations

import secrets
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, Engine, Select, delete, func, insert, select, update

from verisim.study.problems import refuse
from verisim.study.server import freezing, tables
from verisim.study.server.database import (
    Place,
    insert_for,
    prepare_database,
    utc_now,
    writing_engine,
)
from verisim.study.server.design import check_design, load_both, plan_of_first, session_minutes
from verisim.study.server.json_text import to_json
from verisim.study.server.questions import Question
from verisim.study.server.stimulus_set import Stimulus, StimulusSet
from verisim.study.server.study_file import Study

QUESTION_VERSION = 1  # a study with participants is frozen, so no second version can arise yet


@dataclass(frozen=True)
class OpenStudy:
    """A study whose rows are in the database."""

    study: Study
    stimulus_set: StimulusSet
    stimulus_ids: dict[str, int]  # by stimulus name
    question_ids: dict[str, int]  # by question key

    @cached_property
    def size(self) -> tuple[int, int, float]:
        """Trials of a participant without practice, practice trials, and estimated minutes."""
        plan = plan_of_first(self.study, self.stimulus_set)
        num_practice = sum(trial.trial_kind == "practice" for trial in plan)
        minutes = session_minutes(self.study, self.stimulus_set)
        return len(plan) - num_practice, num_practice, round(minutes, 1)

    @cached_property
    def stimulus_by_id(self) -> dict[int, Stimulus]:
        return {number: self.stimulus_by_name[name] for name, number in self.stimulus_ids.items()}

    @cached_property
    def stimulus_by_name(self) -> dict[str, Stimulus]:
        return {stimulus.name: stimulus for stimulus in self.stimulus_set.stimuli}


def open_study(study_path: Path, set_dir: Path, db: Place, mode: str = "open") -> OpenStudy:
    """Loads study and clips, migrates the database and writes what is new.

    Raises StudyError where a file is wrong, where the database belongs to another study, and where
    the study or its clips changed after the first participant came.
    """
    study, stimulus_set = load_both(study_path, set_dir)
    check_design(study, stimulus_set)
    prepare_database(db)
    engine = writing_engine(db)
    try:
        if mode == "live":
            _refuse_unfrozen(engine, study, stimulus_set)
        with engine.begin() as connection:
            opened = _import(connection, study, stimulus_set, db, mode)
            if mode == "live":
                freezing.check_frozen(connection, study, stimulus_set)
        return opened
    finally:
        engine.dispose()


def _refuse_unfrozen(engine: Engine, study: Study, clips: StimulusSet) -> None:
    """Refuses a live study that is not as it was frozen; what differs is in the log by then."""
    with engine.begin() as connection:
        message = freezing.check_frozen(connection, study, clips)
    if message is not None:
        raise refuse(
            study.path,
            message,
            "bring the frozen form back, or freeze again: `verisim study freeze --again REASON`",
        )


def _import(
    connection: Connection, study: Study, clips: StimulusSet, db: Place, mode: str
) -> OpenStudy:
    row = connection.execute(select(tables.study)).mappings().first()
    if row is not None and row["study_id"] != study.name:
        raise refuse(
            db,
            f"holds the study {row['study_id']!r}, not {study.name!r}",
            "give another --db FILE; a database holds one study",
        )
    num = connection.scalar(select(func.count()).select_from(tables.participant))
    if row is not None and num and row["mode"] != mode:
        raise refuse(
            db,
            f"holds {num} participants of the mode {row['mode']!r}, not {mode!r}",
            "pilot and live data are kept apart: give another --db FILE",
        )
    if row is None or not _is_same(row, study, clips):
        if num:
            changed = "study file or texts" if _is_same_set(row, clips) else "clips"
            raise refuse(
                db,
                f"the {changed} changed after {num} participants had come",
                "give another --db FILE for the new form, or bring the old form back",
            )
        _write(connection, study, clips)
    elif row["set_dir"] != str(clips.directory):
        connection.execute(update(tables.study).values(set_dir=str(clips.directory)))
    connection.execute(update(tables.study).values(mode=mode))
    names = select(tables.stimulus.c.name, tables.stimulus.c.stimulus_id)
    keys = select(tables.question.c.key, tables.question.c.question_id)
    return OpenStudy(
        study,
        clips,
        rows_to_ids(connection, names),
        rows_to_ids(connection, keys),
    )


def rows_to_ids(connection: Connection, query: Select[Any]) -> dict[str, int]:
    return {row[0]: row[1] for row in connection.execute(query)}


def _is_same(row: Any, study: Study, clips: StimulusSet) -> bool:
    return row["config_sha256"] == study.config_sha256() and _is_same_set(row, clips)


def _is_same_set(row: Any, clips: StimulusSet) -> bool:
    return row is not None and row["set_sha256"] == clips.sha256


def _write(connection: Connection, study: Study, clips: StimulusSet) -> None:
    """Writes study, questions and stimuli anew; only ever done while nobody has taken part."""
    for table in ("study_stimulus", "condition", "question", "list_slot", "stimulus"):
        connection.execute(delete(tables.metadata.tables[table]))
    row = {
        "study_id": study.name,
        "title": study.title[study.languages[0]],
        "config_json": study.config_json(),
        "config_sha256": study.config_sha256(),
        "set_name": clips.name,
        "set_dir": str(clips.directory),
        "set_sha256": clips.sha256,
        "blind_key": secrets.token_hex(16),
        "withdraw_key": secrets.token_hex(32),
        "state": "open",
        "created_utc": utc_now(),
    }
    connection.execute(
        insert_for(connection, tables.study)
        .values(row)
        .on_conflict_do_update(index_elements=["study_id"], set_=row)
    )
    connection.execute(
        insert(tables.question),
        [
            _question_row(study, question, place)
            for place, asked in (("trial", study.questions), ("session_end", study.end_questions))
            for question in asked
        ],
    )
    conditions: dict[str, int] = {}
    for stimulus in clips.stimuli:
        condition = condition_name(stimulus.factors)
        if condition not in conditions:
            conditions[condition] = _inserted_id(
                connection,
                tables.condition,
                study_id=study.name,
                name=condition,
                factors_json=to_json(stimulus.factors),
            )
        stimulus_id = _inserted_id(connection, tables.stimulus, **_stimulus_row(stimulus))
        connection.execute(
            insert(tables.study_stimulus).values(
                study_id=study.name,
                stimulus_id=stimulus_id,
                condition_id=conditions[condition],
                role=stimulus.role,
            )
        )


def condition_name(factors: dict[str, str]) -> str:
    """{'stiffness': 'low', 'seed': ''} → 'stiffness=low'; no level at all: 'none'."""
    return ", ".join(f"{name}={level}" for name, level in factors.items() if level) or "none"


def _inserted_id(connection: Connection, table: Any, **values: Any) -> int:
    result = connection.execute(insert(table).values(**values))
    key = result.inserted_primary_key
    assert key is not None
    return int(key[0])


def _question_row(study: Study, question: Question, place: str) -> dict[str, Any]:
    scale = question.scale()
    return {
        "study_id": study.name,
        "key": question.key,
        "version": QUESTION_VERSION,
        "kind": question.kind,
        "optional": int(question.optional),
        "scale_min": scale.min if scale else None,
        "scale_max": scale.max if scale else None,
        "scale_step": scale.step if scale else None,
        "prompt_json": to_json(question.prompt),
        "place": place,
        "meaning_json": to_json({lang: question.meaning(lang) for lang in study.languages}),
    }


def _stimulus_row(stimulus: Stimulus) -> dict[str, Any]:
    return {
        "name": stimulus.name,
        "sha256": stimulus.sha256,
        "scene": stimulus.scene,
        "method": stimulus.method,
        "seed": stimulus.seed,
        "reference": stimulus.reference,
        "file": stimulus.file,
        "num_bytes": stimulus.num_bytes,
        "width_px": stimulus.width_px,
        "height_px": stimulus.height_px,
        "frame_rate_hz": stimulus.frame_rate_hz,
        "num_frames": stimulus.num_frames,
        "duration_s": stimulus.duration_s,
        "content_key": stimulus.content_key,
        "provenance_json": to_json(stimulus.sidecar),
    }
