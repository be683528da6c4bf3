# SPDX-License-Identifier: MIT
"""The stimulus set file: which scenes, at which levels, in which roles. Read strictly."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ruamel.yaml.nodes import MappingNode, Node, ScalarNode

from verisim.stimuli.problems import SetError
from verisim.stimuli.yaml_reader import YamlReader, describe, did_you_mean, plain_value

SCHEMA = 1
KEYS = ("schema", "name", "scenes", "factors", "seeds", "roles", "profile", "size")
FACTOR_KEYS = ("set", "levels", "reference", "only")
ROLES = ("practice", "catch")
ROLE_KEYS = ("scene", "name", "set", "seed")
PROFILES = ("stimulus", "master", "preview")
SMALLEST_SIDE, LARGEST_SIDE = 16, 4096  # px
RESERVED_PATHS = {
    "seed": "list seeds under the set's own key seeds",
    "schema": "a scene keeps its schema",
    "name": "a scene keeps its name",
}

IDENTIFIER = re.compile(r"(?!.*__)[A-Za-z0-9][A-Za-z0-9_-]*")
FACTOR_NAME = re.compile(r"(?!.*__)[a-z][a-z0-9_]*")
LEVEL_NAME = re.compile(r"(?!.*__)[A-Za-z0-9.+-][A-Za-z0-9_.+-]*")
SCENE_PATH = re.compile(r"[A-Za-z0-9_-]+|.+\.ya?ml")
KEY_PATH = re.compile(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+)*")
SIZE = re.compile(r"(\d{1,5})x(\d{1,5})")


@dataclass(frozen=True)
class Level:
    """One level of a factor and what it sets in the scene."""

    name: str
    overrides: Mapping[str, Any]  # scene key path → value


@dataclass(frozen=True)
class Factor:
    """A physical or numerical parameter that the set varies."""

    name: str
    levels: tuple[Level, ...]
    reference: str | None  # level that the others are compared with; None: none
    only: tuple[str, ...]  # scenes it applies to; empty: all

    def applies_to(self, scene: str) -> bool:
        return not self.only or scene in self.only


@dataclass(frozen=True)
class RoleClip:
    """A clip beside the design: shown for practice, or to see who pays attention."""

    role: str  # practice | catch
    name: str
    scene: str
    overrides: Mapping[str, Any]
    seed: int


@dataclass(frozen=True)
class StimulusSet:
    file: Path
    name: str
    scenes: tuple[str, ...]  # of the design, in file order
    scene_files: Mapping[str, Path]  # of the design and the roles
    factors: tuple[Factor, ...]
    seeds: tuple[int, ...]
    role_clips: tuple[RoleClip, ...]
    profile: str
    size: tuple[int, int]  # px


def load_set(file: Path | str) -> StimulusSet:
    """The set, checked strictly. Raises SetError with every problem of the file at once.

    The scenes are only looked for here; check.check_set reads them too.
    """
    return _SetReader(Path(file)).read()


class _SetReader(YamlReader):
    """Turns the file's nodes into a StimulusSet and collects what is wrong."""

    def __init__(self, file: Path) -> None:
        super().__init__(file)
        self.scene_files: dict[str, Path] = {}

    def read(self) -> StimulusSet:
        root = self.root()
        if root is None:
            raise SetError(self.problems)
        entries = self.mapping(root, "", KEYS, required=("schema", "name", "scenes"))
        if "schema" in entries:
            self.integer(entries["schema"], "schema", SCHEMA, SCHEMA)
        name = ""
        if "name" in entries:
            name = self.text(entries["name"], "name", IDENTIFIER, "letters, digits, _ and -") or ""
        scenes = self.scenes(entries.get("scenes"))
        factors = self.factors(entries.get("factors"), scenes)
        seeds = self.seeds(entries.get("seeds"))
        role_clips = self.role_clips(entries.get("roles"), seeds[0] if seeds else 1)
        profile = "stimulus"
        if "profile" in entries:
            profile = self.choice(entries["profile"], "profile", PROFILES) or profile
        size = self.size(entries.get("size"))
        if self.problems:
            raise SetError(self.problems)
        return StimulusSet(
            self.file, name, scenes, self.scene_files, factors, seeds, role_clips, profile, size
        )

    def scene(self, node: Node, key: str) -> str | None:
        """A scene's name; its file is NAME.yaml in the folder `scenes` beside the set's folder."""
        text = self.text(node, key, SCENE_PATH, "a scene's name, or a path that ends in .yaml")
        if text is None:
            return None
        folder = self.file.parent
        is_path = text.endswith((".yaml", ".yml"))
        file = folder / text if is_path else folder.parent / "scenes" / f"{text}.yaml"
        name = file.stem
        if not file.is_file():
            known = sorted(path.stem for path in file.parent.glob("*.yaml"))
            hint = did_you_mean(name, known) or (
                f"scenes there: {', '.join(known)}" if known else "paths start at the set's folder"
            )
            self.add(node, key, f"a scene file ({file} does not exist)", hint)
        elif not IDENTIFIER.fullmatch(name):
            self.add(node, key, "a file name of letters, digits, _ and -", "no double underscore")
        elif self.scene_files.setdefault(name, file) != file:
            self.add(node, key, "scenes with different names",
                     f"{self.scene_files[name]} has the same name")  # fmt: skip
        return name

    def scenes(self, node: Node | None) -> tuple[str, ...]:
        names: list[str] = []
        items = self.sequence(node, "scenes", "scene names") if node is not None else []
        for i, item in enumerate(items):
            name = self.scene(item, f"scenes.{i}")
            if name in names:
                self.add(item, f"scenes.{i}", "each scene once")
            elif name is not None:
                names.append(name)
        return tuple(names)

    def factors(self, node: Node | None, scenes: tuple[str, ...]) -> tuple[Factor, ...]:
        if node is None:
            return ()
        factors: list[Factor] = []
        for name, value in self.mapping(node, "factors", None).items():
            key = f"factors.{name}"
            if not FACTOR_NAME.fullmatch(name):
                self.add(value, key, "a name of small letters, digits and single _", seen=name)
            factor = self.factor(name, value, key, scenes)
            for other in factors:
                self.check_apart(value, key, factor, other, scenes)
            factors.append(factor)
        return tuple(factors)

    def factor(self, name: str, node: Node, key: str, scenes: tuple[str, ...]) -> Factor:
        entries = self.mapping(node, key, FACTOR_KEYS, required=("levels",))
        path = self.key_path(entries["set"], f"{key}.set") if "set" in entries else None
        levels: tuple[Level, ...] = ()
        if "levels" in entries:
            levels = self.levels(entries["levels"], f"{key}.levels", path, "set" in entries)
        reference = None
        if "reference" in entries and levels:
            names = [level.name for level in levels]
            reference = self.choice(entries["reference"], f"{key}.reference", names)
        only: list[str] = []
        if "only" in entries:
            for i, item in enumerate(self.sequence(entries["only"], f"{key}.only", "scenes")):
                scene = self.choice(item, f"{key}.only.{i}", scenes)
                only += [scene] if scene is not None else []
        return Factor(name, levels, reference, tuple(only))

    def levels(
        self, node: Node, key: str, path: str | None, has_set: bool
    ) -> tuple[Level, ...]:  # fmt: skip
        """A list of values, or a map from level name to value; without `set` a map from level
        name to {scene key: value, ...}."""
        if isinstance(node, MappingNode):
            pairs = list(self.mapping(node, key, None).items())
        elif has_set:
            pairs = [(describe(item), item) for item in self.sequence(node, key, "values")]
            for _, item in pairs:
                if not isinstance(item, ScalarNode):
                    self.add(item, key, "numbers or words in a list of levels",
                             "give levels names: {low: [0, 0, 1], high: [0, 0, 2]}")  # fmt: skip
                    return ()
        else:
            self.add(node, key, "a map from level name to {scene key: value, ...}",
                     "or name the scene key under set, e.g. set: physics.dt_s")  # fmt: skip
            return ()
        if not pairs:
            self.add(node, key, "at least one level")
        levels: list[Level] = []
        for name, item in pairs:
            here = f"{key}.{name}"
            if not LEVEL_NAME.fullmatch(name):
                self.add(item, here, "a level name of letters, digits, _ . + and -", seen=name)
            overrides = self.settings(item, here) if not has_set else {}
            if has_set:
                value = self.value(item, here)
                overrides = {path: value} if path is not None else {}
            same_value = has_set and any(level.overrides == overrides for level in levels)
            if same_value or any(level.name == name for level in levels):
                self.add(item, here, "each level once")
            levels.append(Level(name, overrides))
        return tuple(levels)

    def key_path(self, node: Node, key: str) -> str | None:
        path = self.text(node, key, KEY_PATH, "the path of a scene key, e.g. physics.dt_s")
        if path in RESERVED_PATHS:
            self.add(node, key, "a scene key that sets may change", RESERVED_PATHS[path])
        return path

    def settings(self, node: Node, key: str) -> dict[str, Any]:
        """A map from scene key path to value; empty: the scene as its file says."""
        settings: dict[str, Any] = {}
        for path, value in self.mapping(node, key, None).items():
            here = f"{key}.{path}"
            if not KEY_PATH.fullmatch(path):
                self.add(value, here, "the path of a scene key, e.g. physics.dt_s", seen=path)
            elif path in RESERVED_PATHS:
                self.add(value, here, "a scene key that sets may change", RESERVED_PATHS[path])
            settings[path] = self.value(value, here)
        return settings

    def check_apart(
        self, node: Node, key: str, factor: Factor, other: Factor, scenes: tuple[str, ...]
    ) -> None:
        """Two factors that meet in a scene must not set the same key."""
        shared = [s for s in scenes if factor.applies_to(s) and other.applies_to(s)]
        for path in sorted(paths_of(factor) & paths_of(other)) if shared else []:
            self.add(node, key, "one factor per scene key",
                     f"factor {other.name} sets {path} in {shared[0]} too; part them with only",
                     seen=path)  # fmt: skip

    def seeds(self, node: Node | None) -> tuple[int, ...]:
        if node is None:
            return (1,)
        seeds: list[int] = []
        for i, item in enumerate(self.sequence(node, "seeds", "whole numbers")):
            seed = self.integer(item, f"seeds.{i}", 0)
            if seed in seeds:
                self.add(item, f"seeds.{i}", "each seed once")
            elif seed is not None:
                seeds.append(seed)
        return tuple(seeds)

    def role_clips(self, node: Node | None, first_seed: int) -> tuple[RoleClip, ...]:
        if node is None:
            return ()
        clips: list[RoleClip] = []
        for role, items in self.mapping(node, "roles", ROLES).items():
            for i, item in enumerate(self.sequence(items, f"roles.{role}", "clips")):
                key = f"roles.{role}.{i}"
                entries = self.mapping(item, key, ROLE_KEYS, required=("scene",))
                scene = self.scene(entries["scene"], f"{key}.scene") if "scene" in entries else None
                name: str | None = str(i + 1)
                if "name" in entries:
                    name = self.text(
                        entries["name"], f"{key}.name", IDENTIFIER, "letters, digits, _ and -"
                    )
                settings = self.settings(entries["set"], f"{key}.set") if "set" in entries else {}
                seed: int | None = first_seed
                if "seed" in entries:
                    seed = self.integer(entries["seed"], f"{key}.seed", 0)
                clip = RoleClip(role, name or "", scene or "", settings, seed or 0)
                if any((c.role, c.scene, c.name) == (role, scene, name) for c in clips):
                    self.add(item, f"{key}.name", "a name of its own for each clip of a scene")
                clips.append(clip)
        return tuple(clips)

    def size(self, node: Node | None) -> tuple[int, int]:
        if node is None:
            return (1280, 720)
        match = SIZE.fullmatch(str(plain_value(node)))
        if match:
            width, height = int(match[1]), int(match[2])
            sides = (width, height)
            if all(SMALLEST_SIDE <= s <= LARGEST_SIDE and s % 2 == 0 for s in sides):
                return sides
        self.add(node, "size", f"WIDTHxHEIGHT in pixels, each even, from {SMALLEST_SIDE} to "
                 f"{LARGEST_SIDE}", "for example 1280x720")  # fmt: skip
        return (1280, 720)


def paths_of(factor: Factor) -> set[str]:
    """The scene keys that a factor changes."""
    return {path for level in factor.levels for path in level.overrides}
