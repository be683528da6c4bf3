# SPDX-License-Identifier: MIT
"""Samplers keep what they promise: counts, balance, order, and what they refuse."""

from __future__ import annotations

import itertools
import random
from collections import Counter

import pytest
from design_tools import crossed, make_stimulus, order_of, plan
from hypothesis import given, settings
from hypothesis import strategies as st

from verisim.study.server.samplers.incomplete_block import find_blocks
from verisim.study.server.samplers.tracks import QuestTracks, longest_run
from verisim.study.server.samplers.units import count_scene_runs, make_units
from verisim.study.server.samplers.williams import williams_rows

CATCH = make_stimulus("broken", "a", "catch")
WARM_UP = make_stimulus("warm-up", "a", "practice")


@pytest.mark.parametrize("num", range(2, 13))
def test_williams_rows_balance_place_and_predecessor(num: int) -> None:
    rows = williams_rows(num)
    assert len(rows) == (num if num % 2 == 0 else 2 * num)
    places = Counter((i, value) for row in rows for i, value in enumerate(row))
    assert len(places) == num * num and len(set(places.values())) == 1
    pairs = Counter(pair for row in rows for pair in itertools.pairwise(row))
    assert len(pairs) == num * (num - 1) and len(set(pairs.values())) == 1


@pytest.mark.parametrize(
    ("num", "size", "most_blocks"), [(7, 3, 7), (13, 4, 13), (8, 4, 14), (9, 4, 18), (6, 3, 10)]
)
def test_blocks_show_each_unit_and_each_two_equally_often(
    num: int, size: int, most_blocks: int
) -> None:
    blocks = find_blocks(num, size)
    assert len(blocks) <= most_blocks
    singles = Counter(itertools.chain.from_iterable(blocks))
    pairs = Counter(p for block in blocks for p in itertools.combinations(sorted(block), 2))
    assert all(len(set(block)) == size for block in blocks)
    assert len(singles) == num and len(set(singles.values())) == 1
    assert len(pairs) == num * (num - 1) // 2 and len(set(pairs.values())) == 1


def test_a_design_that_does_not_exist_is_refused() -> None:
    for size in (1, 40):
        with pytest.raises(ValueError, match="no incomplete block"):
            find_blocks(30, size)
    with pytest.raises(ValueError, match="no balanced design of 40 units"):
        find_blocks(40, 9)


def test_participants_walk_through_the_blocks() -> None:
    clips = crossed("a b c d", "low high ref")  # 8 pairs
    order = order_of(
        "{sampler: balanced_incomplete_block, block_size: 4, seed: 1, pairs: {with: reference}}"
    )
    layouts = ("sequential", "side_by_side")
    shown: Counter[tuple[str, ...]] = Counter()
    sides: Counter[bool] = Counter()
    for list_no in range(14):
        trials = plan(order, clips, list_no, layouts=layouts)
        assert len(trials) == 4
        halves = [trial.layout for trial in trials]
        assert halves[:2] == [layouts[list_no % 2]] * 2 and halves[2:] == [halves[2]] * 2
        assert halves[0] != halves[2]
        shown.update(tuple(sorted(trial.clips)) for trial in trials)
        sides.update(trial.clips[0] == trial.target for trial in trials)
    assert len(shown) == 8 and set(shown.values()) == {7}
    assert sides[True] == sides[False] == 28  # no side is favoured


def test_a_factorial_design_shows_every_cell_and_names_those_missing() -> None:
    clips = crossed("a b", "1 2 3")
    order = order_of("{sampler: factorial, times: 2, seed: 1}")
    for list_no in range(5):
        shown = Counter(trial.clips[0] for trial in plan(order, clips, list_no))
        assert shown == {clip.name: 2 for clip in clips}
    full = [make_stimulus(f"{x}{y}", "a", size=x, speed=y) for x in ("s", "l") for y in ("1", "2")]
    assert order.sampler.find_problems(order.pool(full, "")) == []
    assert order.sampler.find_problems(order.pool(full[1:], "")) == [
        "a: 0 clips at {'size': 's', 'speed': '1', 'seed': 1}; needed: 1"
    ]
    twice = [*full, make_stimulus("other", "a", size="s", speed="1")]
    assert "2 clips at" in order.sampler.find_problems(order.pool(twice, ""))[0]


def test_constant_stimuli_come_evenly_round_by_round() -> None:
    clips = crossed("a b", "1 2 3 4")
    order = order_of("{sampler: constant_stimuli, factor: level, times: 6, seed: 1}")
    trials = plan(order, clips, 0)
    levels = [trial.clips[0].split("-")[1] for trial in trials]
    assert Counter(levels) == {"1": 6, "2": 6, "3": 6, "4": 6}
    for i in range(6):
        assert sorted(levels[4 * i : 4 * i + 4]) == ["1", "2", "3", "4"]
    assert Counter(trial.clips[0] for trial in trials) == {clip.name: 3 for clip in clips}
    other = order_of("{sampler: constant_stimuli, factor: colour, times: 6, seed: 1}")
    assert "has 0 levels" in other.sampler.find_problems(other.pool(clips, ""))[0]


def test_williams_orders_are_complete_over_participants() -> None:
    clips = [*crossed("a b", "1 2 3 4"), CATCH]
    order = order_of("{sampler: williams, factor: level, seed: 1}")
    follows: Counter[tuple[str, str]] = Counter()
    for list_no in range(4):
        trials = [t for t in plan(order, clips, list_no) if t.trial_kind == "test"]
        levels = [trial.clips[0].split("-")[1] for trial in trials]
        assert levels[:4] == levels[4:]  # the same row for each scene
        assert {t.clips[0] for t in trials} == {c.name for c in clips if c.role == "test"}
        follows.update(itertools.pairwise(levels[:4]))
    assert len(follows) == 12 and set(follows.values()) == {1}
    uneven = order.pool([*clips, make_stimulus("x", "c", level="1")], "")
    assert "as many" in order.sampler.find_problems(uneven)[0]


TRACKS = (
    "{sampler: quest_plus, seed: 1, question: plausible, undistorted: 4, tracks: ["
    "{name: up, factor: level, undistorted: 1, direction: up, trials: 10, scale: ratio},"
    "{name: down, factor: level, undistorted: 1, direction: down, trials: 10, scale: ratio}]}"
)


def test_tracks_interleave_and_keep_to_their_side() -> None:
    clips = crossed("a", "0.25 0.5 0.75 1.5 2 4 1")
    order = order_of(TRACKS)
    trials = plan(order, clips, 0)
    assert Counter(trial.track for trial in trials) == {"up": 10, "down": 10, "": 4}
    assert all(trial.clips == ("a-1",) for trial in trials if not trial.track)
    assert longest_run([trial.track for trial in trials]) <= 3
    sampler = order.sampler
    assert isinstance(sampler, QuestTracks)
    up, down = sampler.track("up").clips(clips), sampler.track("down").clips(clips)
    assert [clip.name for _, clip in up] == ["a-1.5", "a-2", "a-4"]
    assert [clip.name for _, clip in down] == ["a-0.75", "a-0.5", "a-0.25"]
    assert [round(m, 3) for m, _ in down] == [0.415, 1, 2]


def test_the_next_clip_follows_the_answers() -> None:
    clips = crossed("a", "1.1 1.3 1.6 2 2.6 3.4 4.5 6 1")
    sampler = order_of(TRACKS).sampler
    assert isinstance(sampler, QuestTracks)

    def next_after(history: list[tuple[str, bool]]) -> float:
        clip = sampler.next_clip("up", clips, history, "yes_no", random.Random(1))
        return float(clip.factors["level"])

    first = next_after([])
    assert 1.3 < first < 4.5
    assert next_after([(f"a-{first:g}", True)] * 3) < first
    assert next_after([(f"a-{first:g}", False)] * 3) > first


def test_what_was_achieved_counts_before_what_was_asked_for() -> None:
    clips = [
        make_stimulus(f"a-{level}", "a", achieved={"level": value}, level=level)
        for level, value in (("x", 1.2), ("y", 1.8), ("2", 3.1))
    ]
    sampler = order_of(TRACKS).sampler
    assert isinstance(sampler, QuestTracks)
    sizes = [round(2**size, 3) for size, _ in sampler.track("up").clips(clips)]
    assert sizes == [1.2, 1.8, 3.1]


def test_a_track_without_levels_is_named() -> None:
    order = order_of(TRACKS)
    problems = order.sampler.find_problems(order.pool(crossed("a", "1.5 2 4 1"), ""))
    assert problems == ["track 'down': 0 levels down from 1 among the clips; needed: 3"]


def test_blocks_follow_each_other_and_take_the_catch_trials_where_order_is_free() -> None:
    clips = [*crossed("a b", "1 2 3 4"), CATCH, WARM_UP]
    order = order_of(
        "{sampler: blocks, seed: 1, never_twice_running: scene, blocks: ["
        "{sampler: williams, factor: level, scenes: [a]},"
        "{sampler: factorial, scenes: [b]}]}"
    )
    for list_no in range(6):
        trials = plan(order, clips, list_no)
        assert trials[0].trial_kind == "practice"
        assert [t.clips[0][0] for t in trials[1:5]] == ["a"] * 4
        assert sorted(t.clips[0] for t in trials[5:] if t.trial_kind == "test") == [
            "b-1",
            "b-2",
            "b-3",
            "b-4",
        ]
        assert [t.trial_kind for t in trials[5:]].count("catch") == 1


def test_people_of_a_cell_see_its_level_alone() -> None:
    clips = [
        make_stimulus(f"{scene}-{context}", scene, context=context)
        for scene in ("a", "b")
        for context in ("plain", "rich")
    ] + [CATCH, WARM_UP]
    order = order_of("{sampler: random, seed: 1, between: {factor: context, quota: 3}}")
    assert order.cells(clips) == ["plain", "rich"]
    for cell in ("plain", "rich"):
        names = {name for trial in plan(order, clips, 0, cell) for name in trial.clips}
        assert names == {f"a-{cell}", f"b-{cell}", "broken", "warm-up"}
    scenes = order_of("{sampler: random, seed: 1, between: {factor: scene}}")
    assert scenes.cells(clips) == ["a", "b"]
    assert {t.clips[0] for t in plan(scenes, clips, 0, "b") if t.trial_kind == "test"} == {
        "b-plain",
        "b-rich",
    }


def test_repeats_come_late_and_never_at_once() -> None:
    clips = [*crossed("a b c", "1 2 3 4"), CATCH]
    order = order_of("{sampler: random, seed: 1, repeats: 0.25, never_twice_running: scene}")
    for list_no in range(50):
        trials = plan(order, clips, list_no)
        repeats = [i for i, trial in enumerate(trials) if trial.trial_kind == "repeat"]
        assert len(repeats) == 3
        for i in repeats:
            first = next(j for j, trial in enumerate(trials) if trial.clips == trials[i].clips)
            assert trials[first].trial_kind == "test" and i - first >= 2 and i >= 8


def test_pairs_need_a_reference_of_their_scene() -> None:
    clips = [*crossed("a", "1 2 ref"), CATCH, make_stimulus("alone", "z", "catch")]
    assert [u.name for u in make_units(clips, "test", "reference")] == [
        "a-1 | a-ref",
        "a-2 | a-ref",
    ]
    assert [u.name for u in make_units(clips, "catch", "reference")] == ["broken | a-ref"]
    assert len(make_units(clips, "test", "all")) == 3


@settings(max_examples=60, deadline=None)
@given(
    counts=st.lists(st.integers(1, 6), min_size=2, max_size=5),
    catches=st.integers(0, 3),
    list_no=st.integers(0, 1000),
)
def test_every_order_is_complete_and_scenes_are_apart(
    counts: list[int], catches: int, list_no: int
) -> None:
    clips = [
        make_stimulus(f"{scene}{i}", str(scene)) for scene, n in enumerate(counts) for i in range(n)
    ]
    clips += [make_stimulus(f"catch{i}", f"catch{i}", "catch") for i in range(catches)]
    order = order_of("{sampler: random, seed: 5, never_twice_running: scene}")
    trials = plan(order, clips, list_no)
    assert sorted(t.clips[0] for t in trials) == sorted(clip.name for clip in clips)
    assert plan(order, list(reversed(clips)), list_no) == trials
    if 2 * max(counts) <= len(clips):
        by_name = {clip.name: clip.scene for clip in clips}
        scenes = [by_name[t.clips[0]] for t in trials]
        assert all(a != b for a, b in itertools.pairwise(scenes))
    assert count_scene_runs([]) == 0
