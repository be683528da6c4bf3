# SPDX-License-Identifier: MIT
"""Every point that a scene's chart will hold: a contestant at a setting, ready to be run."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from verisim import engine
from verisim.bench import peers
from verisim.bench.chart.bench_scene import BenchScene
from verisim.bench.chart.ladder import Ladder, Rung, Times
from verisim.bench.chart.trial import scene_document
from verisim.bench.problems import BenchError

PEER_STEPS = {"dt 1/60": 1 / 60, "dt 1/240": 1 / 240, "dt 1/1000": 1e-3, "dt 1/4000": 1 / 4000}
QUICK_PEER_STEPS = ("dt 1/60", "dt 1/240")
# What the engine chooses depends on none of these.
NOT_PROBED = ("physics.dt_s", "physics.steps_per_contact", "duration_s")
PROBE_S = 1e-6  # long enough for the engine to say what it chooses
ORDER = ("particle_size_m", "max_penetration_m", "stiffness_n_m", "dt_s")  # later needs earlier


@dataclass(frozen=True)
class Entry:
    """One point of the chart."""

    method: str  # key of a ladder, or engine-config of a peer
    setting: str
    overrides: Mapping[str, Any]  # by scene path; of a peer the step alone, as dt_s
    is_peer: bool = False
    is_finest: bool = False

    @property
    def name(self) -> str:
        return f"{self.method}: {self.setting}"


def own_entries(
    scene: BenchScene, file: Path, ladders: Sequence[Ladder], *, quick: bool
) -> list[Entry]:
    """The rungs of our own methods that can be posed in this scene."""
    entries = []
    for ladder in ladders:
        if ladder.key in scene.not_posed:
            continue
        base = {f"physics.{key}": value for key, value in ladder.base.items()}
        base |= scene.settings.get(ladder.key, {})
        if quick and scene.quick_duration_s is not None:
            base["duration_s"] = scene.quick_duration_s
        for rung in ladder.rungs:
            wanted = rung.is_quick or (scene.needs_reference and rung.is_finest)
            if (quick or scene.is_dear) and not wanted:
                continue
            overrides = resolve(file, base, rung)
            if overrides is not None:
                entries.append(Entry(ladder.key, rung.name, overrides, is_finest=rung.is_finest))
    return entries


def choose_peers(names: Sequence[str], say: Callable[[str], None]) -> list[str]:
    """The engines of these names that are ready, installed where they were missing; "all": every
    one, and what could not be installed is said. Raises BenchError for unknown names, and for a
    named engine that cannot be installed."""
    known = list(dict.fromkeys(config.engine for config in peers.contestants()))
    if unknown := [name for name in names if name not in (*known, "all")]:
        raise BenchError(
            f"--peers: saw {', '.join(map(repr, unknown))}; allowed: all, {', '.join(known)}\n"
            "  hint: separate several engines by commas"
        )
    ready = []
    for name in known if "all" in names else names:
        try:
            peers.install(name, say)
        except peers.PeerError as error:
            if "all" not in names:
                raise BenchError(f"--peers {name}: {error}") from error
            say(f"left out: {error}")
            continue
        ready.append(name)
    return ready


def peer_entries(
    scene: BenchScene, file: Path, engines: Sequence[str], *, quick: bool
) -> tuple[list[Entry], dict[str, str]]:
    """The settings of other engines that can be posed in this scene; why others cannot."""
    if not engines:
        return [], {}
    base: dict[str, Any] = {}
    if quick and scene.quick_duration_s is not None:
        base["duration_s"] = scene.quick_duration_s
    posed = peers.peer_scene(file, base)
    steps = QUICK_PEER_STEPS if quick or scene.is_dear else tuple(PEER_STEPS)
    entries, refused = [], {}
    for config in peers.contestants():
        if config.engine not in engines:
            continue
        if why := peers.cannot_pose(config, posed):
            refused[config.key] = why
            continue
        for name in steps:
            overrides = {**base, "dt_s": PEER_STEPS[name]}
            is_finest = name == steps[-1]
            entries.append(Entry(config.key, name, overrides, is_peer=True, is_finest=is_finest))
    return entries, refused


def resolve(file: Path, base: Mapping[str, Any], rung: Rung) -> dict[str, Any] | None:
    """The rung's settings as overrides; None where the scene has nothing that they are about.

    A multiple is of what the engine chooses for the settings before it (the step follows from the
    stiffness).
    """
    overrides = dict(base)
    for key, value in rung.settings.items():
        if not isinstance(value, Times):
            overrides[f"physics.{key}"] = value
    for key in ORDER:
        multiple = rung.settings.get(key)
        if isinstance(multiple, Times):
            chosen = _chosen(file, overrides, key)
            if chosen is None:
                return None
            overrides[f"physics.{key}"] = float(f"{multiple.factor * chosen:.3g}")
    duration = overrides.get("duration_s") or scene_document(file)["duration_s"]
    is_too_long = overrides.get("physics.dt_s", 0) > duration
    return None if is_too_long else overrides


def _chosen(file: Path, overrides: Mapping[str, Any], key: str) -> float | None:
    if key == "particle_size_m":
        return _default_particle_size(file)
    own = {name: value for name, value in overrides.items() if name not in NOT_PROBED}
    return _probed(file, file.stat().st_mtime_ns, tuple(sorted(own.items())), key)


@lru_cache(maxsize=64)
def _probed(file: Path, _mtime_ns: int, overrides: tuple[tuple[str, Any], ...], key: str) -> float:
    probe = {**dict(overrides), "duration_s": PROBE_S}
    if key == "dt_s":  # a scene may name its own, which no duration may be shorter than
        named = scene_document(file).get("physics", {}).get("dt_s", PROBE_S)
        probe["duration_s"] = max(PROBE_S, named)
    else:
        probe["physics.dt_s"] = PROBE_S
    run = engine.simulate(file, probe)
    if key == "max_penetration_m":
        return float(run.summary["chosen"]["max_penetration_m"])
    return float(run.parameters[key])


def _default_particle_size(file: Path) -> float | None:
    """A quarter of the smallest extent of the free boxes; None if there are none."""
    bodies = scene_document(file)["bodies"]
    free = [body["shape"] for body in bodies if body.get("motion", "free") == "free"]
    boxes = [min(shape["box_m"]) for shape in free if "box_m" in shape]
    return min(boxes) / 4 if boxes else None
