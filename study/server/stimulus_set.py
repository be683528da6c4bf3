# SPDX-License-Identifier: MIT
"""Reads a stimulus directory: manifest, sidecars, and whether the clips are the ones named."""

from __future__ import annotations

import csv
import hashlib
import json
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from verisim.study.problems import Problem, StudyError, refuse

ROLES = ("test", "practice", "catch")
BUILD_HINT = "build it again: `verisim stimuli build SET -o DIR`"
FACTOR = "factor_"


@dataclass(frozen=True)
class Stimulus:
    """One row of the manifest and its clip's sidecar."""

    name: str
    scene: str
    role: str  # test | practice | catch
    method: str
    seed: int | None
    reference: str  # name of its reference level's stimulus, '' if none
    file: str  # relative to the directory
    sha256: str
    num_bytes: int
    width_px: int
    height_px: int
    frame_rate_hz: float
    num_frames: int
    duration_s: float
    content_key: str
    factors: dict[str, str]
    sidecar: dict[str, Any]


@dataclass(frozen=True)
class StimulusSet:
    """A directory of clips; `sha256` names the whole content the study depends on."""

    directory: Path
    name: str
    stimuli: list[Stimulus]
    factor_names: list[str]
    sha256: str

    def clip_path(self, stimulus: Stimulus) -> Path:
        return self.directory / stimulus.file


def load_stimulus_set(directory: Path) -> StimulusSet:
    """Reads and verifies a stimulus directory. Raises StudyError with every problem found."""
    directory = directory.resolve()
    manifest = directory / "manifest.csv"
    if not manifest.is_file():
        raise refuse(manifest, "no such file", "make the clips: `verisim stimuli build SET -o DIR`")
    name = _read_set_name(directory)
    with manifest.open(newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        columns = list(reader.fieldnames or [])
        rows = list(reader)
    reading = _Reading(directory, manifest)
    missing = [column for column in _COLUMNS if column not in columns]
    if missing:
        raise refuse(manifest, f"columns missing: {', '.join(missing)}", BUILD_HINT)
    factor_names = [c.removeprefix(FACTOR) for c in columns if c.startswith(FACTOR)]
    stimuli = [reading.stimulus(i + 2, row, factor_names) for i, row in enumerate(rows)]
    reading.check_names(stimuli)
    if not any(stimulus.role == "test" for stimulus in stimuli):
        reading.complain(1, "no clip with role test", "a study needs at least one clip to rate")
    if reading.problems:
        raise StudyError(reading.problems)
    digest = hashlib.sha256(
        "".join(
            f"{s.name}\t{s.role}\t{s.sha256}\n" for s in sorted(stimuli, key=lambda s: s.name)
        ).encode()
    ).hexdigest()
    return StimulusSet(directory, name, stimuli, factor_names, digest)


def _read_set_name(directory: Path) -> str:
    path = directory / "set.json"
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise refuse(path, f"cannot be read: {error}", BUILD_HINT) from error
    name = document.get("name") if isinstance(document, dict) else None
    if not isinstance(name, str):
        raise refuse(path, "has no name", BUILD_HINT)
    return name


def _whole(text: str) -> int:
    value = int(text)
    if value < 0:
        raise ValueError(text)
    return value


def _positive(text: str) -> float:
    value = float(text)
    if not math.isfinite(value) or value <= 0:
        raise ValueError(text)
    return value


def _sha256(text: str) -> str:
    if len(text) != 64 or set(text) - set("0123456789abcdef"):
        raise ValueError(text)
    return text


def _filled(text: str) -> str:
    if not text or not text.isprintable():
        raise ValueError(text)
    return text


def _role(text: str) -> str:
    if text not in ROLES:
        raise ValueError(text)
    return text


# column → (what is allowed, how to read it)
_COLUMNS: dict[str, tuple[str, Callable[[str], Any]]] = {
    "stimulus": ("a printable name", _filled),
    "scene": ("a printable name", _filled),
    "role": (" | ".join(ROLES), _role),
    "method": ("a printable name", _filled),
    "seed": ("a whole number or empty", lambda text: _whole(text) if text else None),
    "reference": ("a stimulus of this file or empty", str),
    "file": ("a path inside the directory", _filled),
    "sha256": ("64 hexadecimal digits", _sha256),
    "num_bytes": ("a whole number", _whole),
    "width_px": ("a whole number", _whole),
    "height_px": ("a whole number", _whole),
    "frame_rate_hz": ("a number above 0", _positive),
    "num_frames": ("a whole number", _whole),
    "duration_s": ("a number above 0", _positive),
    "content_key": ("text", str),
}


@dataclass
class _Reading:
    """Collects the problems of one manifest."""

    directory: Path
    manifest: Path
    problems: list[Problem] = field(default_factory=list)

    def complain(self, line: int, message: str, hint: str = BUILD_HINT) -> None:
        self.problems.append(Problem(f"{self.manifest}:{line}", message, hint))

    def stimulus(self, line: int, row: dict[str, str], factor_names: list[str]) -> Stimulus:
        values: dict[str, Any] = {}
        for column, (allowed, read) in _COLUMNS.items():
            text = row[column] or ""
            try:
                values[column] = read(text)
            except ValueError:
                self.complain(line, f"{column}: {text!r} is not allowed; allowed: {allowed}")
                values[column] = None
        if values["file"] and values["sha256"]:
            self.check_clip(line, values)
        factors = {name: row[FACTOR + name] or "" for name in factor_names}
        sidecar = self.sidecar(line, values["file"], values["sha256"]) if values["file"] else {}
        return Stimulus(name=values.pop("stimulus"), factors=factors, sidecar=sidecar, **values)

    def check_clip(self, line: int, values: dict[str, Any]) -> None:
        path = (self.directory / values["file"]).resolve()
        if not path.is_relative_to(self.directory):
            self.complain(line, f"file: {values['file']!r} lies outside the directory")
        elif not path.is_file():
            self.complain(line, f"file: {path} does not exist")
        elif (seen := file_sha256(path)) != values["sha256"]:
            self.complain(
                line, f"{path} has sha256 {seen[:12]}…, the manifest says {values['sha256'][:12]}…"
            )
        elif path.stat().st_size != values["num_bytes"]:
            self.complain(
                line, f"num_bytes: {path} has {path.stat().st_size}, not {values['num_bytes']}"
            )

    def sidecar(self, line: int, file: str, sha256: str | None) -> dict[str, Any]:
        path = self.directory / Path(file).with_suffix(".json")
        try:
            document = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            self.complain(line, f"sidecar {path} cannot be read: {error}")
            return {}
        if not isinstance(document, dict):
            self.complain(line, f"sidecar {path} is not a JSON object")
            return {}
        if document.get("video_sha256", sha256) != sha256:
            self.complain(
                line, f"sidecar {path} describes another video (its video_sha256 differs)"
            )
        return document

    def check_names(self, stimuli: list[Stimulus]) -> None:
        names: set[str] = set()
        for i, stimulus in enumerate(stimuli):
            if stimulus.name in names:
                self.complain(i + 2, f"stimulus: {stimulus.name!r} is listed twice")
            names.add(stimulus.name)
        for i, stimulus in enumerate(stimuli):
            if stimulus.reference and stimulus.reference not in names:
                self.complain(
                    i + 2, f"reference: {stimulus.reference!r} is no stimulus of this file"
                )


def file_sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
