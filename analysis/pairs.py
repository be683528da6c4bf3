# SPDX-License-Identifier: MIT
"""Choices between two clips: how often the reference is found, d′, bias, and a common scale."""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from scipy.stats import norm

from verisim.analysis.agreement import SEED
from verisim.analysis.codebook import Question
from verisim.analysis.load import Export
from verisim.analysis.preference_scale import FIRST, SECOND, TIE, fit_scale
from verisim.analysis.scores import CONFIDENCE, mean_interval

CHOICE = "choice"
ALL_LAYOUTS = "all"
SCALE_DRAWS = 200  # bootstrap over people; a fit takes some ms
MIN_SHARE_OF_DRAWS = 0.95  # that have a scale, or there is no interval
PAIR_COLUMNS = (
    "participants", "question", "stimulus", "reference", "layout", "n", "num_answers",
    "num_reference", "num_other", "num_not_sure", "mean", "ci_low", "ci_high",
    "d_prime", "d_prime_low", "d_prime_high",
)  # fmt: skip
BIAS_COLUMNS = (
    "participants", "question", "layout", "n", "num_answers", "num_not_sure",
    "share_first", "share_first_low", "share_first_high", "d_prime", "bias_c",
)  # fmt: skip
SCALE_COLUMNS = (
    "participants", "question", "scene", "stimulus", "n", "strength", "ci_low", "ci_high",
    "tie", "not_computed",
)  # fmt: skip


@dataclass(frozen=True)
class PairFindings:
    """People found: one row per participant × clip, 1 reference chosen, 0.5 not sure, 0 other."""

    cells: pd.DataFrame
    found: pd.DataFrame
    bias: pd.DataFrame
    scale: pd.DataFrame


def as_share(question: Question) -> Question:
    """A choice as it is charted: the share that chose the reference, between 0 and 1."""
    if question.kind != CHOICE:
        return question
    ends = ("other clip chosen", "reference chosen")
    return replace(question, minimum=0.0, maximum=1.0, ends=ends)


def pair_answers(export: Export, participants: frozenset[str]) -> pd.DataFrame:
    """Every choice in a test trial, with the clip that was compared with its reference.

    Adds `first` (1 first or left clip, 0 second, 0.5 not sure), and where one clip is the other's
    reference `clip`, `reference` and `right` (1 reference chosen, 0.5 not sure, 0 other).
    """
    rows = export.tables["ratings"]
    rows = rows[
        (rows["trial_kind"] == "test")
        & (rows["question_kind"] == CHOICE)
        & (rows["stimulus_b"] != "")
        & rows["participant_id"].isin(participants)
        & (rows["value"].notna() | (rows["value_text"] != ""))
    ]
    rows = rows[
        ["question", "participant_id", "layout", "scene", "stimulus", "stimulus_b", "value"]
    ]
    stimuli = export.tables["stimuli"]
    reference_of = dict(zip(stimuli["stimulus"], stimuli["reference"], strict=True))
    first = np.where(rows["value"].isna(), 0.5, np.where(rows["value"] == 1, 1.0, 0.0))
    a, b = rows["stimulus"], rows["stimulus_b"]
    second_is_reference = a.map(reference_of) == b
    first_is_reference = b.map(reference_of) == a
    return rows.assign(
        first=first,
        clip=np.where(second_is_reference, a, np.where(first_is_reference, b, "")),
        reference=np.where(second_is_reference, b, np.where(first_is_reference, a, "")),
        right=np.where(
            first_is_reference, first, np.where(second_is_reference, 1 - first, math.nan)
        ),
    )


def analyse_pairs(export: Export, sets: dict[str, frozenset[str]]) -> PairFindings:
    """Everything about choices. sets: name -> participants, as Cohort.sets gives them."""
    answers = {name: pair_answers(export, people) for name, people in sets.items()}
    found = [row for name, rows in answers.items() for row in _found_rows(name, rows)]
    bias = [row for name, rows in answers.items() for row in _bias_rows(name, rows)]
    scale = [row for name, rows in answers.items() for row in _scale_rows(name, rows, export)]
    known = answers["all"][answers["all"]["clip"] != ""]
    cells = known.groupby(["question", "clip", "participant_id"], sort=True)["right"].mean()
    return PairFindings(
        cells.reset_index().rename(columns={"clip": "stimulus", "right": "value"}),
        pd.DataFrame(found, columns=list(PAIR_COLUMNS)),
        pd.DataFrame(bias, columns=list(BIAS_COLUMNS)),
        pd.DataFrame(scale, columns=list(SCALE_COLUMNS)),
    )


def wilson(share: float, n: int) -> tuple[float, float]:
    """The 95 % score interval of a proportion (Wilson 1927; Newcombe 1998, method 3).

    share: of n people. Halves ("not sure") are allowed: they spread less than whole answers, so
    that the interval is then on the safe side.
    """
    z = float(norm.ppf(0.5 + CONFIDENCE / 2))
    middle = (share + z * z / (2 * n)) / (1 + z * z / n)
    half = z * math.sqrt(share * (1 - share) / n + z * z / (4 * n * n)) / (1 + z * z / n)
    return max(0.0, middle - half), min(1.0, middle + half)


def d_prime(share: float) -> float:
    """d′ of a share of right answers in two-alternative choice without bias: √2 Φ⁻¹(share).

    Green and Swets (1966); tabled by Hacker and Ratcliff (1979). Infinite at 0 and 1.
    """
    return math.sqrt(2) * float(norm.ppf(share))


def _found_rows(people: str, answers: pd.DataFrame) -> Iterator[list[object]]:
    known = answers[answers["clip"] != ""]
    both = pd.concat([known.assign(layout=ALL_LAYOUTS), known])
    for (question, clip, layout), rows in both.groupby(["question", "clip", "layout"], sort=True):
        by_person = rows.groupby("participant_id")["right"].mean().to_numpy()
        n, share = len(by_person), float(np.sort(by_person).mean())
        low, high = wilson(share, n)
        counts = [int((rows["right"] == value).sum()) for value in (1, 0, 0.5)]
        # Half an answer more on either side (Hautus 1995), so that all or none is no infinity.
        smooth = (share * n + 0.5) / (n + 1)
        ends = [d_prime(end) if 1e-9 < end < 1 - 1e-9 else math.nan for end in (low, high)]
        about = [people, question, clip, rows["reference"].iloc[0], layout]
        yield [*about, n, len(rows), *counts, share, low, high, d_prime(smooth), *ends]


def _bias_rows(people: str, answers: pd.DataFrame) -> Iterator[list[object]]:
    """Per layout: how often the first or left clip is chosen, and d′ freed of that leaning.

    With H and F the shares of "first" where the reference came first and where it came second,
    d′ = (z(H) - z(F)) / √2 and c = -(z(H) + z(F)) / 2 (Macmillan and Creelman 2005, chapter 7);
    c above 0 leans towards the second or right clip.
    """
    for (question, layout), rows in answers.groupby(["question", "layout"], sort=True):
        by_person = rows.groupby("participant_id")["first"].mean().to_numpy()
        share, _, low, high = mean_interval(by_person)
        z = []
        for is_first in (True, False):
            firsts = rows.loc[(rows["reference"] == rows["stimulus"]) == is_first]
            firsts = firsts[firsts["clip"] != ""]
            z.append(float(norm.ppf((firsts["first"].sum() + 0.5) / (len(firsts) + 1))))
        not_sure = int((rows["first"] == 0.5).sum())
        about = [people, question, layout, len(by_person), len(rows), not_sure]
        limits = [min(1.0, max(0.0, end)) for end in (low, high)]
        yield [*about, share, *limits, (z[0] - z[1]) / math.sqrt(2), -(z[0] + z[1]) / 2]


def _scale_rows(people: str, answers: pd.DataFrame, export: Export) -> Iterator[list[object]]:
    """A common scale for scenes whose clips were compared with more than their reference."""
    stimuli = export.tables["stimuli"]
    for (question, scene), rows in answers.groupby(["question", "scene"], sort=True):
        if (rows["clip"] != "").all():
            continue  # each clip met its reference alone: the shares say all there is
        clips = sorted({*rows["stimulus"], *rows["stimulus_b"]})
        own = stimuli[stimuli["stimulus"].isin(clips)]
        zero = list(own.loc[own["reference"] == "", "stimulus"])
        counts = _counts_by_person(rows, clips)
        total = fit_scale(counts.sum(axis=0))
        about = [people, question, scene]
        if total is None:
            why = "some clip was always, or never, preferred, or was not compared"
            for clip in clips:
                yield [*about, clip, len(counts), math.nan, math.nan, math.nan, math.nan, why]
            continue
        at = clips.index(zero[0]) if len(zero) == 1 else None
        strengths = _from(total.strengths, at)
        lows, highs = _scale_interval(counts, at, f"{people} {question} {scene}")
        for k, clip in enumerate(clips):
            figures = [strengths[k], lows[k], highs[k], total.tie]
            yield [*about, clip, len(counts), *figures, ""]


def _counts_by_person(rows: pd.DataFrame, clips: list[str]) -> np.ndarray:
    """Choices [person, i, j, outcome] with i < j, as fit_scale takes them."""
    place = {clip: k for k, clip in enumerate(clips)}
    people = {name: k for k, name in enumerate(sorted(set(rows["participant_id"])))}
    counts = np.zeros((len(people), len(clips), len(clips), 3))
    columns = ("participant_id", "stimulus", "stimulus_b", "first")
    for person, first, second, chosen in zip(*(rows[name] for name in columns), strict=True):
        a, b = place[first], place[second]
        outcome = TIE if chosen == 0.5 else FIRST if (chosen == 1) == (a < b) else SECOND
        counts[people[person], min(a, b), max(a, b), outcome] += 1
    return counts


def _from(strengths: np.ndarray, zero: int | None) -> np.ndarray:
    return strengths if zero is None else strengths - strengths[zero]


def _scale_interval(
    counts: np.ndarray, zero: int | None, name: str
) -> tuple[np.ndarray, np.ndarray]:
    """Percentile bootstrap over people; NaN where too many draws have no scale."""
    rng = np.random.default_rng([SEED, zlib.crc32(name.encode())])
    draws = []
    for _ in range(SCALE_DRAWS):
        people = rng.integers(len(counts), size=len(counts))
        scale = fit_scale(counts[people].sum(axis=0))
        if scale is not None:
            draws.append(_from(scale.strengths, zero))
    if len(draws) < MIN_SHARE_OF_DRAWS * SCALE_DRAWS:
        nothing = np.full(counts.shape[1], math.nan)
        return nothing, nothing
    low, high = np.percentile(draws, [2.5, 97.5], axis=0)
    return low, high
