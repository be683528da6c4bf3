# SPDX-License-Identifier: MIT
"""manifest.csv and set.json: what a stimulus directory holds, for the study and the analysis."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from verisim.stimuli.expand import Stimulus, file_sha256, reference_levels
from verisim.stimuli.make_stimulus import Folder
from verisim.stimuli.set_file import SCHEMA, StimulusSet

COLUMNS = (
    "stimulus",
    "scene",
    "role",
    "method",
    "seed",
    "reference",
    "file",
    "sha256",
    "num_bytes",
    "width_px",
    "height_px",
    "frame_rate_hz",
    "num_frames",
    "duration_s",
    "content_key",
)


def write_manifest(
    folder: Folder,
    stimulus_set: StimulusSet,
    stimuli: Sequence[Stimulus],
    sidecars: Sequence[Mapping[str, Any]],
    content_keys: Sequence[str],
) -> None:
    """One row per clip: who it is, which bytes, and its level of each factor."""
    rows = []
    for stimulus, sidecar, key in zip(stimuli, sidecars, content_keys, strict=True):
        clip = folder.clip(stimulus.id)
        row = {
            "stimulus": stimulus.id,
            "scene": stimulus.scene,
            "role": stimulus.role,
            "method": sidecar["method"],
            "seed": stimulus.seed,
            "reference": stimulus.reference,
            "file": clip.relative_to(folder.directory).as_posix(),
            "sha256": sidecar["video_sha256"],
            "num_bytes": clip.stat().st_size,
            "width_px": sidecar["width_px"],
            "height_px": sidecar["height_px"],
            "frame_rate_hz": sidecar["frame_rate_hz"],
            "num_frames": sidecar["num_frames"],
            "duration_s": sidecar["num_frames"] / sidecar["frame_rate_hz"],
            "content_key": key,
        }
        rows.append(row | {f"factor_{name}": level for name, level in stimulus.levels.items()})
    columns = [*COLUMNS, *(f"factor_{factor.name}" for factor in stimulus_set.factors)]
    write_csv(folder.manifest, columns, rows)


def write_set_json(folder: Folder, stimulus_set: StimulusSet) -> None:
    """The set in brief, beside its manifest."""
    from verisim.clip import write_json

    content = {
        "schema": SCHEMA,
        "name": stimulus_set.name,
        "profile": stimulus_set.profile,
        "factor_names": [factor.name for factor in stimulus_set.factors],
        "reference_levels": reference_levels(list(stimulus_set.factors)),
        "set_sha256": file_sha256(stimulus_set.file),
    }
    write_json(folder.directory / "set.json", content)


def write_csv(file: Path, columns: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> None:
    """UTF-8, comma, LF, empty = missing; written under a temporary name and renamed."""
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    temporary = file.with_name(f".{file.name}.{os.getpid()}.tmp")
    try:
        temporary.write_text(text.getvalue(), "utf-8")
        temporary.replace(file)
    finally:
        temporary.unlink(missing_ok=True)
