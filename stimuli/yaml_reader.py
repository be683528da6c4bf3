# SPDX-License-Identifier: MIT
"""YAML read strictly: every value keeps its line, and every problem is collected, none raised."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from verisim.stimuli.problems import Problem

LARGEST_INTEGER = 2**53 - 1  # what every reader of JSON and CSV can hold
_TAG = "tag:yaml.org,2002:"


class YamlReader:
    """Reads one file; `problems` fills up as the getters are called."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.problems: list[Problem] = []

    def root(self) -> Node | None:
        """The file's top node, or None with the reason among the problems."""
        try:
            text = self.file.read_text("utf-8")
        except (OSError, UnicodeDecodeError) as error:
            reason = getattr(error, "strerror", None) or "not UTF-8 text"
            self.problems.append(
                Problem(str(self.file), "", reason, "a YAML file that can be read")
            )
            return None
        try:
            node: Node | None = YAML(typ="safe", pure=True).compose(text)
        except MarkedYAMLError as error:
            line = error.problem_mark.line + 1 if error.problem_mark else 1
            self.problems.append(
                Problem(f"{self.file}:{line}", "", str(error.problem), "YAML",
                        "indent with spaces; lists are [a, b], maps {key: value}")
            )  # fmt: skip
            return None
        except YAMLError as error:
            self.problems.append(Problem(str(self.file), "", str(error), "YAML"))
            return None
        if node is None:
            self.problems.append(Problem(str(self.file), "", "an empty file", "a map of keys"))
        return node

    def where(self, node: Node) -> str:
        return f"{self.file}:{node.start_mark.line + 1}"

    def add(self, node: Node, key: str, allowed: str, hint: str = "", seen: str = "") -> None:
        self.problems.append(Problem(self.where(node), key, seen or describe(node), allowed, hint))

    def mapping(
        self, node: Node, key: str, known: Iterable[str] | None, required: Iterable[str] = ()
    ) -> dict[str, Node]:
        """Entries of a map by name; unknown, repeated and missing keys become problems.

        known: None = any name is allowed.
        """
        names = None if known is None else list(known)
        if not isinstance(node, MappingNode):
            self.add(node, key, "a map" if names is None else "a map of: " + ", ".join(names))
            return {}
        entries: dict[str, Node] = {}
        for name_node, value in node.value:
            name = name_node.value if isinstance(name_node, ScalarNode) else describe(name_node)
            path = f"{key}.{name}" if key else name
            if name in entries:
                self.add(name_node, path, "each key once", seen="the same key twice")
            elif names is not None and name not in names:
                self.add(name_node, path, "one of: " + ", ".join(names),
                         did_you_mean(name, names), seen="an unknown key")  # fmt: skip
            else:
                entries[name] = value
        for name in required:
            if name not in entries:
                path = f"{key}.{name}" if key else name
                self.add(node, path, "this key is required", seen="nothing")
        return entries

    def sequence(self, node: Node, key: str, of: str) -> list[Node]:
        """Items of a list that is not empty."""
        if not isinstance(node, SequenceNode) or not node.value:
            self.add(node, key, f"a list of {of}, at least one")
            return []
        return list(node.value)

    def text(self, node: Node, key: str, pattern: re.Pattern[str], allowed: str) -> str | None:
        if isinstance(node, ScalarNode) and pattern.fullmatch(node.value):
            return str(node.value)
        self.add(node, key, allowed)
        return None

    def choice(self, node: Node, key: str, choices: Iterable[str]) -> str | None:
        names = list(choices)
        if isinstance(node, ScalarNode) and node.value in names:
            return str(node.value)
        seen = node.value if isinstance(node, ScalarNode) else ""
        self.add(node, key, "one of: " + ", ".join(names), did_you_mean(seen, names))
        return None

    def integer(self, node: Node, key: str, least: int, most: int = LARGEST_INTEGER) -> int | None:
        value = plain_value(node) if isinstance(node, ScalarNode) else None
        if isinstance(value, int) and not isinstance(value, bool) and least <= value <= most:
            return value
        self.add(node, key, f"a whole number from {least} to {most}")
        return None

    def value(self, node: Node, key: str) -> Any:
        """Any value a scene key can take: a number, text, a list or a map of them."""
        found = plain_value(node)
        if has(found, lambda item: item is None):
            self.add(node, key, "a number, text, a list or a map", "null means nothing here")
        elif has(found, lambda item: isinstance(item, float) and not math.isfinite(item)):
            self.add(node, key, "finite numbers")
        return found


def plain_value(node: Node) -> Any:
    """A node as Python values: dict, list, str, int, float, bool or None."""
    if isinstance(node, MappingNode):
        return {str(plain_value(k)): plain_value(v) for k, v in node.value}
    if isinstance(node, SequenceNode):
        return [plain_value(item) for item in node.value]
    kind, text = str(node.tag).removeprefix(_TAG), str(node.value)
    if kind == "int":
        digits = text.replace("_", "")
        return int(digits) if digits.lstrip("+-").isdigit() else int(digits, 0)  # 0x10, 0o17
    if kind == "float":
        return float(text.replace("_", "").replace(".inf", "inf").replace(".nan", "nan"))
    if kind == "bool":
        return text.lower() == "true"
    return None if kind == "null" else text


def has(value: Any, test: Callable[[Any], bool]) -> bool:
    """Whether the test holds for the value or for anything inside it."""
    if isinstance(value, dict):
        return any(has(item, test) for item in value.values())
    if isinstance(value, list):
        return any(has(item, test) for item in value)
    return test(value)


def describe(node: Node) -> str:
    """A node as it would be written on one line."""
    if isinstance(node, MappingNode):
        items = (f"{describe(k)}: {describe(v)}" for k, v in node.value)
        return "{" + ", ".join(items) + "}"
    if isinstance(node, SequenceNode):
        return "[" + ", ".join(map(describe, node.value)) + "]"
    return str(node.value) or "nothing"


def did_you_mean(seen: str, names: Iterable[str]) -> str:
    close = difflib.get_close_matches(seen, list(names), n=1)
    return f"did you mean {close[0]}?" if close else ""
