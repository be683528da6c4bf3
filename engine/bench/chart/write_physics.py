# SPDX-License-Identifier: MIT
"""Puts settings into a scene file's `physics` block and leaves every other byte as it is."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap

from verisim import engine

PREFIX = "physics."


def write_physics(file: Path, overrides: Mapping[str, Any]) -> None:
    """Sets `physics.KEY` values in the file, comments kept; the file appears whole, and only if
    the engine takes it. Raises SceneError."""
    text = with_physics(file.read_text("utf-8"), overrides)
    part = file.with_name(f".{file.stem}.{os.getpid()}.part.yaml")  # beside it: paths are relative
    try:
        part.write_text(text, "utf-8")
        engine.check_scene(part)
        part.replace(file)
    finally:
        part.unlink(missing_ok=True)


def with_physics(text: str, overrides: Mapping[str, Any]) -> str:
    """The scene's text with these values in its `physics` block, added if there is none."""
    values = {key.removeprefix(PREFIX): value for key, value in overrides.items()}
    if text.lstrip().startswith("{"):
        return _with_physics_in_braces(text, values)
    yaml = YAML()
    yaml.width = 4096
    document = yaml.load(text)
    lines = text.splitlines(keepends=True)
    if "physics" not in document:
        block = CommentedMap()
        physics = CommentedMap(values)
        physics.fa.set_flow_style()
        block["physics"] = physics
        end = "" if not lines or lines[-1].endswith("\n") else "\n"
        return text + end + _dumped(yaml, block)
    first = document.lc.key("physics")[0]
    later = [document.lc.key(key)[0] for key in document]
    last = min((line for line in later if line > first), default=len(lines))
    block = yaml.load("".join(lines[first:last]))
    if block["physics"] is None:
        block["physics"] = CommentedMap()
    block["physics"].update(values)
    return "".join(lines[:first]) + _dumped(yaml, block) + "".join(lines[last:])


def _with_physics_in_braces(text: str, values: Mapping[str, Any]) -> str:
    """The same for JSON, and for YAML in braces: without physics it gets some before all else."""
    yaml = YAML()
    yaml.width = 4096
    document = yaml.load(text)
    if "physics" not in document:
        start = text.index("{") + 1
        more = "," if document else ""
        return f'{text[:start]}\n "physics": {json.dumps(values)}{more}{text[start:]}'
    document["physics"].update(values)
    return _dumped(yaml, document)


def _dumped(yaml: YAML, block: CommentedMap) -> str:
    buffer = io.StringIO()
    yaml.dump(block, buffer)
    return buffer.getvalue()
