# SPDX-License-Identifier: MIT
"""QUEST+ against the examples of Watson 2017 (Journal of Vision 17(3):10), trial by trial."""

from __future__ import annotations

import numpy as np
import pytest

from verisim.study.server.samplers.quest_plus import (
    Array,
    QuestPlus,
    cumulative_normal,
    weibull_db,
)

DB = list(range(-40, 1))
# Each example: contrasts (dB) that the method chose, and what the observer answered (1 = correct).
EXAMPLE_1 = (
    "-18 -22 -25 -28 -30 -22 -13 -15 -16 -18 -19 -20 -21 -22 -23 -19 -20 -20 -18 -18 -19 -17 -17"
    " -18 -18 -18 -19 -19 -19 -19 -19 -19",
    "11110011111111011011011111111111",
)
THRESHOLD_AND_SLOPE = (
    "-18 -22 -12 -13 -15 -16 -17 -18 -19 -21 -24 -25 -26 -27 -21 -22 -23 -20 -20 -20 -21 -19 -19"
    " -20 -20 -20 -19 -19 -19 -19 -19 -20 -20 -20 -20 -20 -21 -21 -20 -20 -20 -19 -18 -18 -19 -19"
    " -19 -18 -18 -17 -18 -18 -18 -17 -17 -17 -17 -17 -17 -17 -18 -18 -18 -18",
    "1011111111111011011101111011111111111011001111010111011111111111",
)
EXAMPLE_2_START = (
    "-18 -22 -25 -28 -30 -21 -12 -14 -15 -16 -18 -19 -20 -22 -23 -18 -19 -16 -17 -17 -18 -18 -18"
    " -19 -19 -17 -17 -18 -18 -18 -18 -19 -19 -20 -18 -18 -18 -18 -18 -19 -19 -19 -19 -20 -18 -18"
    " -18 -18 -18 -18 -18 -18 -18 -19 -19 -19 -20 -18 -18 -18 -18 -19 -19 -19 -18 -18 -18 -18 -19"
    " -19 -19 -19 -19 -19 -19 -19 -20 -21 -19 -19 -19 -19 -19 -19 -19 -18 -19 -19 -16 -16 -16 -16"
    " -16 -16 0 0",
    "111100111111110101111111011111111011111111101110111111110111111011111111111110101111011011111111",
)
EXAMPLE_3_START = (
    "0 -1 2 -2 2 3 3 -5 3 3 3 3 -7 -7 -7 -7 4 -7 4 4 4 -8 -8 -8 4 -8 4 -8 -7 4 -7 -7 4 -7 4 -7",
    "100111111101000011011000101001001010",
)


def follow(quest: QuestPlus, stimuli: str, answers: str) -> None:
    for i, (stimulus, answer) in enumerate(zip(stimuli.split(), answers, strict=True)):
        chosen = quest.next_stimulus()
        assert quest.stimuli[chosen] == float(stimulus), f"trial {i}"
        quest.update(chosen, answer == "1")


def test_threshold_alone_follows_the_first_example() -> None:
    quest = QuestPlus(DB, DB, [3.5], [0.5], [0.02], weibull_db)
    follow(quest, *EXAMPLE_1)
    assert quest.mode() == (-20, 3.5, 0.5, 0.02)


def test_threshold_and_slope_follow_the_example_of_the_implementation() -> None:
    quest = QuestPlus(DB, DB, [2, 3, 4, 5], [0.5], [0.02], weibull_db)
    follow(quest, *THRESHOLD_AND_SLOPE)
    assert quest.mode()[:2] == (-20, 3)


def test_threshold_slope_and_lapse_follow_the_second_example() -> None:
    lapses = [0, 0.01, 0.02, 0.03, 0.04]
    quest = QuestPlus(DB, DB, [2, 3, 4, 5], [0.5], lapses, weibull_db)
    follow(quest, *EXAMPLE_2_START)


def test_mean_sd_and_lapse_follow_the_third_example() -> None:
    def two_sided(x: Array, mean: Array, sd: Array, guess: Array, lapse: Array) -> Array:
        del guess  # the example has one rate for both ends
        return cumulative_normal(x, mean, sd, lapse, lapse)

    lapses = [0, 0.01, 0.02, 0.03, 0.04]
    angles = list(range(-10, 11))
    quest = QuestPlus(angles, range(-5, 6), range(1, 11), [0], lapses, two_sided)
    follow(quest, *EXAMPLE_3_START)


@pytest.mark.parametrize("threshold", [-0.6, 0.0, 0.5])
def test_a_known_threshold_is_recovered(threshold: float) -> None:
    rng = np.random.default_rng(3)
    stimuli = np.linspace(-1, 1, 11)
    errors = []
    for _ in range(40):
        grid = np.linspace(-1.2, 1.2, 31).tolist()
        quest = QuestPlus(stimuli.tolist(), grid, [0.1, 0.2], [0.02, 0.1], [0.0, 0.03])
        for _ in range(40):
            i = quest.next_stimulus()
            chance = cumulative_normal(
                stimuli[i], *(np.asarray(v) for v in (threshold, 0.15, 0.05, 0.02))
            )
            quest.update(i, bool(rng.random() < chance))
        errors.append(quest.estimate().threshold - threshold)
    assert abs(np.mean(errors)) < 0.06  # measured 0.003 to 0.02
    assert np.std(errors) < 0.15  # measured 0.06


def test_an_impossible_outcome_leaves_the_posterior_as_it_was() -> None:
    quest = QuestPlus([0.0], [-9.0], [0.1], [0.0], [0.0])
    quest.update(0, False)
    assert quest.posterior_p.tolist() == [1.0]
