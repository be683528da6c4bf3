# SPDX-License-Identifier: MIT
"""Reads a YAML file strictly: every value knows its line, every problem is collected."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, SequenceNode

from verisim.study.problems import Problem, StudyError, refuse

KeyPath = tuple[str | int, ...]
MAX_DEPTH = 16  # a study file needs 5; a deeper one is a mistake or an attack by alias

PLAIN_TAGS = ("tag:yaml.org,2002:map", "tag:yaml.org,2002:seq")
MISSING: Any = object()


class YamlSource:
    """A parsed YAML file: plain values in `root`, the line of each in `lines`, problems so far."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.problems: list[Problem] = []
        self.lines: dict[KeyPath, int] = {(): 1}
        self.root: Any = self._load()

    def complain(self, at: KeyPath, message: str, hint: str = "") -> None:
        """Notes a problem at a key; a key that is missing is reported at its parent's line."""
        parent = at
        while parent not in self.lines:
            parent = parent[:-1]
        name = path_text(at)
        where = f"{self.path}:{self.lines[parent]}"
        self.problems.append(Problem(where, f"{name}: {message}" if name else message, hint))

    def raise_problems(self) -> None:
        if self.problems:
            raise StudyError(self.problems)

    def _load(self) -> Any:
        try:
            text = self.path.read_text(encoding="utf-8")
        except OSError as error:
            raise refuse(
                self.path, f"cannot be read: {error.strerror}", "give an existing YAML file"
            ) from error
        except UnicodeDecodeError as error:
            raise refuse(
                self.path, f"is not UTF-8 text (byte {error.start})", "save it as UTF-8"
            ) from error
        self._yaml = YAML(typ="safe", pure=True)
        try:
            node = self._yaml.compose(text)
            return {} if node is None else self._convert(node, ())
        except MarkedYAMLError as error:
            line = error.problem_mark.line + 1 if error.problem_mark else 1
            raise refuse(
                f"{self.path}:{line}",
                f"not YAML: {error.problem or error.context}",
                "check indentation, colons and quotes of this line",
            ) from error
        except YAMLError as error:
            raise refuse(self.path, f"not YAML: {error}", "check the file's characters") from error

    def _convert(self, node: Node, at: KeyPath) -> Any:
        self.lines.setdefault(at, node.start_mark.line + 1)
        if len(at) > MAX_DEPTH:
            raise refuse(
                f"{self.path}:{self.lines[at]}",
                f"nested deeper than {MAX_DEPTH} levels",
                "flatten it",
            )
        if isinstance(node, SequenceNode | MappingNode) and str(node.tag) not in PLAIN_TAGS:
            where = f"{self.path}:{self.lines[at]}"
            raise refuse(where, f"not YAML we read: the tag {node.tag}", "remove the tag")
        if isinstance(node, SequenceNode):
            return [self._convert(item, (*at, i)) for i, item in enumerate(node.value)]
        if not isinstance(node, MappingNode):
            return self._yaml.constructor.construct_object(node)
        result: dict[str, Any] = {}
        for key_node, value_node in node.value:
            key = str(key_node.value) if isinstance(key_node.value, str) else repr(key_node.value)
            if key in result:
                self.lines[(*at, key)] = key_node.start_mark.line + 1
                self.complain((*at, key), "written twice", "keep one of the two")
                continue
            self.lines[(*at, key)] = key_node.start_mark.line + 1
            result[key] = self._convert(value_node, (*at, key))
        return result


class Section:
    """A mapping in the file whose keys are taken one by one; `finish` reports those nobody took."""

    def __init__(self, source: YamlSource, value: Any, at: KeyPath = ()) -> None:
        self.source = source
        self.at = at
        self.taken: list[str] = []
        if not isinstance(value, dict):
            source.complain(at, f"{show(value)} is not a mapping", "write `key: value` lines")
            value = {}
        self.value: dict[str, Any] = value

    def complain(self, key: str, message: str, hint: str = "") -> None:
        self.source.complain((*self.at, key), message, hint)

    def has(self, key: str) -> bool:
        return key in self.value

    def take(
        self, key: str, allowed: str, accept: Callable[[Any], bool], default: Any = MISSING
    ) -> Any:
        """Returns the key's value if `accept` holds, else notes the problem and returns None."""
        self.taken.append(key)
        if key not in self.value:
            if default is not MISSING:
                return default
            self.complain(key, f"missing; allowed: {allowed}", f"add `{key}: …`")
            return None
        value = self.value[key]
        if accept(value):
            return value
        self.complain(key, f"{show(value)} is not allowed; allowed: {allowed}", "change the value")
        return None

    def text(self, key: str, *, max_chars: int = 500, default: Any = MISSING) -> Any:
        allowed = f"text of 1 to {max_chars} characters"
        return self.take(key, allowed, lambda v: is_text(v, max_chars), default)

    def name(self, key: str) -> Any:
        return self.take(key, "lower-case letters, digits and _, at most 40", is_name)

    def choice(self, key: str, options: Sequence[Any], default: Any = MISSING) -> Any:
        allowed = " | ".join(str(option) for option in options)
        return self.take(key, allowed, lambda v: not isinstance(v, bool) and v in options, default)

    def flag(self, key: str, default: bool) -> Any:
        return self.take(key, "true | false", lambda v: isinstance(v, bool), default)

    def integer(self, key: str, low: int, high: int, default: Any = MISSING) -> Any:
        allowed = f"a whole number from {low} to {high}"
        return self.take(key, allowed, lambda v: is_integer(v) and low <= v <= high, default)

    def number(self, key: str, low: float, high: float, default: Any = MISSING) -> Any:
        allowed = f"a number from {low:g} to {high:g}"
        return self.take(key, allowed, lambda v: is_number(v) and low <= v <= high, default)

    def section(self, key: str, *, required: bool = True) -> Section:
        """Returns the sub-mapping (empty where the key is missing)."""
        self.taken.append(key)
        if key not in self.value:
            if required:
                self.complain(
                    key, "missing; allowed: a mapping", f"add `{key}:` with its keys below it"
                )
            return Section(self.source, {}, (*self.at, key))
        return Section(self.source, self.value[key], (*self.at, key))

    def localized(
        self, key: str, languages: Sequence[str], allowed: str, accept: Callable[[Any], bool]
    ) -> dict[str, Any]:
        """Returns {language: value}; there must be exactly one value per language of the study."""
        section = self.section(key)
        if key not in self.value:
            return {}
        values = {language: section.take(language, allowed, accept) for language in languages}
        section.finish()
        return values

    def finish(self) -> None:
        """Reports every key that nobody asked for."""
        for key in self.value:
            if key not in self.taken:
                allowed = ", ".join(self.taken) or "none"
                self.complain(
                    key, f"unknown key; allowed: {allowed}", "correct its spelling or remove it"
                )


def is_text(value: Any, max_chars: int) -> bool:
    return isinstance(value, str) and len(value.strip()) > 0 and len(value) <= max_chars


def is_name(value: Any) -> bool:
    return (
        isinstance(value, str)
        and 0 < len(value) <= 40
        and value.isascii()
        and value[0].isalpha()
        and value == value.lower()
        and value.replace("_", "").isalnum()
    )


def is_integer(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def show(value: Any) -> str:
    """A value as the reader wrote it, cut to a readable length."""
    if value is None:
        text = "null"
    elif isinstance(value, bool):
        text = "true" if value else "false"
    else:
        text = repr(value)
    return text if len(text) <= 80 else text[:77] + "…"


def path_text(at: KeyPath) -> str:
    """('questions', 2, 'points') → questions[2].points"""
    text = ""
    for part in at:
        text += f"[{part}]" if isinstance(part, int) else (f".{part}" if text else part)
    return text
