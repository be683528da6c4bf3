# SPDX-License-Identifier: MIT
"""Sampler `quest_plus`: interleaved adaptive tracks; each next clip is chosen on the server."""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from verisim.study.server.achieved import achieved_level
from verisim.study.server.samplers.quest_plus import QuestPlus
from verisim.study.server.samplers.sampler import Pool, Sampler
from verisim.study.server.samplers.units import Unit
from verisim.study.server.stimulus_set import Stimulus
from verisim.study.server.yaml_source import Section, is_number

NUM_THRESHOLDS = 31
SLOPES = (0.05, 0.1, 0.2, 0.4)  # standard deviations on the axis of log10(magnitude)
GUESSES = {"yes_no": (0.02, 0.1, 0.25), "choice": (0.5,)}
LAPSES = (0.0, 0.03)
MAX_LIKE_RUN = 3  # trials of one track that may follow each other, as far as the counts allow


@dataclass(frozen=True)
class Track:
    """One signed series of levels of one factor, from the undistorted level outwards."""

    name: str
    factor: str
    scene: str | None
    undistorted: float
    direction: str  # up | down
    scale: str  # difference: |level - undistorted|; ratio: |log2(level / undistorted)|
    trials: int

    def magnitude(self, level: float) -> float:
        """Returns how far a level lies from the undistorted one; negative: on the other side."""
        sign = 1 if self.direction == "up" else -1
        if self.scale == "ratio":
            return sign * math.log2(level / self.undistorted)
        return sign * (level - self.undistorted)

    def clips(self, stimuli: Sequence[Stimulus]) -> list[tuple[float, Stimulus]]:
        """Returns this track's clips, weakest manipulation first, with their magnitudes."""
        found: list[tuple[float, Stimulus]] = []
        for stimulus in stimuli:
            if stimulus.role != "test" or self.scene not in (None, stimulus.scene):
                continue
            level = achieved_level(stimulus, self.factor)
            if level is None or (self.scale == "ratio" and level <= 0):
                continue
            magnitude = self.magnitude(level)
            if magnitude > 1e-9:
                found.append((magnitude, stimulus))
        return sorted(found, key=lambda pair: (pair[0], pair[1].name))


@dataclass(frozen=True)
class QuestTracks(Sampler):
    """Tracks take turns at random; `undistorted` clips are mixed in as ordinary test trials."""

    name: ClassVar[str] = "quest_plus"

    question: str
    tracks: tuple[Track, ...]
    undistorted: int

    @classmethod
    def read(cls, section: Section) -> QuestTracks:
        items = section.take(
            "tracks", "a list of tracks", lambda v: isinstance(v, list) and len(v) > 0
        )
        tracks = tuple(
            _read_track(Section(section.source, item, (*section.at, "tracks", i)))
            for i, item in enumerate(items or [])
        )
        if len({track.name for track in tracks}) < len(tracks):
            section.complain("tracks", "two tracks have the same name", "rename one")
        return cls(
            question=section.name("question"),
            tracks=tracks,
            undistorted=section.integer("undistorted", 0, 500, 0),
        )

    def choose(self, pool: Pool, list_no: int, rng: random.Random) -> list[Unit]:
        del list_no
        units = [
            Unit((), "test", track.name, track.scene or "")
            for track in self.tracks
            for _ in range(track.trials)
        ]
        plain = self._undistorted(pool)
        if self.undistorted and plain and pool.pairs is None:
            units += [plain[i % len(plain)] for i in range(self.undistorted)]
        rng.shuffle(units)
        return spread_tracks(units, rng)

    def _undistorted(self, pool: Pool) -> list[Unit]:
        manipulated = {clip.name for t in self.tracks for _, clip in t.clips(pool.stimuli)}
        return [unit for unit in pool.tests if unit.clips[0].name not in manipulated]

    def track(self, name: str) -> Track:
        return next(track for track in self.tracks if track.name == name)

    def next_clip(
        self,
        name: str,
        stimuli: Sequence[Stimulus],
        history: Sequence[tuple[str, bool]],
        kind: str,
        rng: random.Random,
    ) -> Stimulus:
        """Returns the clip that says most; history: (stimulus, was the fault noticed), in order.

        Clips of equal magnitude (other seeds, other scenes) take turns at random.
        """
        clips = self.track(name).clips(stimuli)
        quest = replay(clips, history, kind)
        best = magnitudes(clips)[quest.next_stimulus()]
        return rng.choice([clip for magnitude, clip in clips if magnitude == best])

    def find_problems(self, pool: Pool) -> list[str]:
        problems = []
        for track in self.tracks:
            num = len(magnitudes(track.clips(pool.stimuli)))
            if num < 3:
                problems.append(
                    f"track {track.name!r}: {num} levels {track.direction} from "
                    f"{track.undistorted:g} among the clips; needed: 3"
                )
        if self.undistorted and not self._undistorted(pool):
            problems.append("no clip without manipulation for the `undistorted` trials")
        return problems

    def describe(self, pool: Pool) -> list[str]:
        lines = []
        for track in self.tracks:
            sizes = ", ".join(f"{m:.3g}" for m in magnitudes(track.clips(pool.stimuli)))
            lines.append(f"track {track.name}: {track.trials} trials over magnitudes {sizes}")
        return lines


def _read_track(section: Section) -> Track:
    track = Track(
        name=section.name("name"),
        factor=section.name("factor"),
        scene=section.take("scene", "a scene of the set", lambda v: isinstance(v, str), None),
        undistorted=section.take("undistorted", "a number", is_number),
        direction=section.choice("direction", ("up", "down")),
        scale=section.choice("scale", ("difference", "ratio"), "difference"),
        trials=section.integer("trials", 1, 500),
    )
    if track.scale == "ratio" and is_number(track.undistorted) and track.undistorted <= 0:
        section.complain("undistorted", "a ratio needs a number above 0")
    section.finish()
    return track


def magnitudes(clips: Sequence[tuple[float, Stimulus]]) -> list[float]:
    return list(dict.fromkeys(magnitude for magnitude, _ in clips))


def replay(
    clips: Sequence[tuple[float, Stimulus]], history: Sequence[tuple[str, bool]], kind: str
) -> QuestPlus:
    """Returns the state of a track after its history. kind of question: yes_no | choice."""
    sizes = magnitudes(clips)
    axis = [math.log10(size) for size in sizes]
    thresholds = np.linspace(axis[0] - 0.2, axis[-1] + 0.2, NUM_THRESHOLDS).tolist()
    quest = QuestPlus(axis, thresholds, SLOPES, GUESSES[kind], LAPSES)
    index = {clip.name: sizes.index(magnitude) for magnitude, clip in clips}
    for stimulus, noticed in history:
        quest.update(index[stimulus], noticed)
    return quest


def spread_tracks(units: list[Unit], rng: random.Random) -> list[Unit]:
    """Swaps units so that no track runs longer than MAX_LIKE_RUN, where the counts allow it."""
    result = list(units)
    for i in range(MAX_LIKE_RUN, len(result)):
        run = {unit.track for unit in result[i - MAX_LIKE_RUN : i + 1]}
        if len(run) == 1:
            others = [j for j in range(i + 1, len(result)) if result[j].track not in run]
            if others:
                j = rng.choice(others)
                result[i], result[j] = result[j], result[i]
    return result


def longest_run(units: Sequence[Any]) -> int:
    return max((len(list(group)) for _, group in itertools.groupby(units)), default=0)
