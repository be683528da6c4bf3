# SPDX-License-Identifier: MIT
"""Chooses the next clip of an adaptive track, in the transaction that stores the answer before."""

from __future__ import annotations

import random

from sqlalchemy import Connection, select, update

from verisim.study.server import tables
from verisim.study.server.expected import expected_choice, is_as_expected, read_expected
from verisim.study.server.json_text import to_json
from verisim.study.server.open_study import OpenStudy
from verisim.study.server.questions.answer import Answer
from verisim.study.server.questions.yes_no import YesNoQuestion
from verisim.study.server.samplers import find_tracks
from verisim.study.server.samplers.units import find_standard


def choose_next_clip(connection: Connection, opened: OpenStudy, participant_id: str) -> None:
    """Fills in the clip of the participant's first open trial where a track must choose it."""
    sampler = find_tracks(opened.study.order.sampler)
    if sampler is None:
        return
    trial = tables.trial.c
    row = connection.execute(
        select(tables.trial, tables.assignment.c.seed, tables.participant.c.cell)
        .join(tables.assignment, tables.assignment.c.participant_id == trial.participant_id)
        .join(tables.participant, tables.participant.c.participant_id == trial.participant_id)
        .where(trial.participant_id == participant_id, trial.answered_utc.is_(None))
        .order_by(trial.trial_index)
        .limit(1)
    ).first()
    if row is None or row.stimulus_a is not None:
        return
    order = opened.study.order
    pool = order.pool(opened.stimulus_set.stimuli, row.cell)
    kind = opened.study.question(sampler.question).kind
    rng = random.Random(f"{row.seed}:{row.trial_index}:track")
    history = track_history(connection, opened, participant_id, row.track, row.seed)
    chosen = sampler.next_clip(row.track, pool.stimuli, history, kind, rng)
    clips = [chosen.name]
    expected = None
    if order.pairs is not None:
        standard = find_standard(chosen, pool.stimuli)
        assert standard is not None  # the design's check demands a reference
        clips.append(standard.name)
        if rng.random() < 0.5:
            clips.reverse()
        expected = expected_choice(opened.study, tuple(clips), standard.name)
    connection.execute(
        update(tables.trial)
        .where(trial.trial_id == row.trial_id)
        .values(
            stimulus_a=opened.stimulus_ids[clips[0]],
            stimulus_b=opened.stimulus_ids[clips[1]] if len(clips) == 2 else None,
            expected_json=to_json(expected) if expected else None,
        )
    )


def track_history(
    connection: Connection, opened: OpenStudy, participant_id: str, track: str, seed: str
) -> list[tuple[str, bool]]:
    """Returns (manipulated clip, was the fault noticed) of a track's answered trials, in order."""
    sampler = find_tracks(opened.study.order.sampler)
    assert sampler is not None
    question = opened.study.question(sampler.question)
    trial, response = tables.trial.c, tables.response.c
    rows = connection.execute(
        select(tables.trial, response.value, response.value_text)
        .join(tables.response, response.trial_id == trial.trial_id)
        .where(
            trial.participant_id == participant_id,
            trial.track == track,
            response.question_id == opened.question_ids[question.key],
        )
        .order_by(trial.trial_index)
    ).all()
    history: list[tuple[str, bool]] = []
    for row in rows:
        names = [
            opened.stimulus_by_id[number].name
            for number in (row.stimulus_a, row.stimulus_b)
            if number is not None
        ]
        if isinstance(question, YesNoQuestion):
            noticed = question.finds_wrong(Answer(row.value, None))
        else:
            expected = read_expected(row.expected_json)
            assert expected is not None  # set when the pair was chosen
            names.remove(names[int(expected["is"]) - 1])
            # "Not sure" counts half; a coin from the stored seed stands for it.
            coin = random.Random(f"{seed}:{row.trial_index}:not_sure").random() < 0.5
            noticed = coin if row.value is None else is_as_expected(expected, row.value)
        history.append((names[0], noticed))
    return history
