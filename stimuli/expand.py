# SPDX-License-Identifier: MIT
"""A stimulus set spelled out: scenes × levels × seeds, each with a stable id and a content key."""

from __future__ import annotations

import hashlib
import itertools
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from verisim.stimuli.set_file import Factor, StimulusSet

FILE_KEYS = ("mesh", "poses")  # scene keys whose value is another file


@dataclass(frozen=True)
class Stimulus:
    """One clip to be made."""

    id: str  # e.g. box_stack__stiffness-low__s1
    scene: str
    scene_file: Path
    role: str  # test | practice | catch
    seed: int
    levels: Mapping[str, str]  # factor → level; factors that do not apply are absent
    overrides: Mapping[str, Any]  # scene key path → value
    reference: str  # id of the stimulus at the reference levels; "": it is one, or there is none


def expand(stimulus_set: StimulusSet) -> list[Stimulus]:
    """Every stimulus of the set: the design scene by scene, then practice and catch clips."""
    stimuli: list[Stimulus] = []
    for scene in stimulus_set.scenes:
        factors = [factor for factor in stimulus_set.factors if factor.applies_to(scene)]
        for choice in itertools.product(*(factor.levels for factor in factors)):
            for seed in stimulus_set.seeds:
                names = {f.name: level.name for f, level in zip(factors, choice, strict=True)}
                overrides = {p: v for level in choice for p, v in level.overrides.items()}
                own_id = design_id(scene, names, seed)
                reference = design_id(scene, names | reference_levels(factors), seed)
                stimuli.append(
                    Stimulus(
                        id=own_id,
                        scene=scene,
                        scene_file=stimulus_set.scene_files[scene],
                        role="test",
                        seed=seed,
                        levels=names,
                        overrides={**overrides, "seed": seed},
                        reference="" if reference == own_id else reference,
                    )
                )
    for clip in stimulus_set.role_clips:
        stimuli.append(
            Stimulus(
                id=f"{clip.scene}__{clip.role}-{clip.name}__s{clip.seed}",
                scene=clip.scene,
                scene_file=stimulus_set.scene_files[clip.scene],
                role=clip.role,
                seed=clip.seed,
                levels={},
                overrides={**clip.overrides, "seed": clip.seed},
                reference="",
            )
        )
    return stimuli


def reference_levels(factors: Iterator[Factor] | list[Factor]) -> dict[str, str]:
    """The level of each factor that others are compared with; factors without one are absent."""
    return {f.name: f.reference for f in factors if f.reference is not None}


def design_id(scene: str, levels: Mapping[str, str], seed: int) -> str:
    """Stable name of a stimulus: the same scene, levels and seed give the same id, in any set."""
    parts = [scene, *(f"{factor}-{level}" for factor, level in levels.items()), f"s{seed}"]
    return "__".join(parts)


def content_key(
    stimulus: Stimulus, profile: str, size: tuple[int, int], engine: Mapping[str, str]
) -> str:
    """sha256 over everything that decides the clip's bytes.

    engine: version and build of the engine, as engine_build() gives them. Graphics drivers are
    left out: a clip made with another driver is still this clip.
    """
    parts = {
        "scene": file_sha256(stimulus.scene_file),
        "files": {name: file_sha256(file) for name, file in sorted(named_files(stimulus).items())},
        "overrides": dict(stimulus.overrides),
        "profile": profile,
        "size": list(size),
        "engine": dict(engine),
    }
    text = json.dumps(parts, sort_keys=True, ensure_ascii=True, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def named_files(stimulus: Stimulus) -> dict[str, Path]:
    """Files that the scene or the overrides name (meshes, poses), by name as written."""
    try:
        document = YAML(typ="safe", pure=True).load(stimulus.scene_file.read_text("utf-8"))
    except YAMLError:
        document = None  # the engine's loader will say what is wrong with it
    names = set(_file_names(document))
    for path, value in stimulus.overrides.items():
        names |= set(_file_names({path.rpartition(".")[2]: value}))
    files = {name: stimulus.scene_file.parent / name for name in names}
    return {name: file for name, file in files.items() if file.is_file()}


def _file_names(value: Any) -> Iterator[str]:
    if isinstance(value, dict):
        for key, item in value.items():
            if key in FILE_KEYS and isinstance(item, str):
                yield item
            else:
                yield from _file_names(item)
    elif isinstance(value, list):
        for item in value:
            yield from _file_names(item)


def file_sha256(file: Path) -> str:
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
