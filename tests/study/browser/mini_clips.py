# SPDX-License-Identifier: MIT
"""Stimulus directories of tiny clips: as a build leaves them, without simulating anything."""

from __future__ import annotations

import csv
import hashlib
import json
import struct
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from verisim.stimuli.expand import expand
from verisim.stimuli.set_file import load_set

NUM_FRAMES = 18
FRAME_RATE_HZ = 60
SIZE = (320, 180)


def write_set(directory: Path, name: str, clips: Sequence[Mapping[str, Any]]) -> Path:
    """Writes manifest and set.json, and for each of `clips` (manifest columns) file and sidecar.

    All clips show the same test picture; a few bytes at the end of the file tell them apart.
    """
    directory.mkdir(parents=True, exist_ok=True)
    picture = directory / "picture.mp4"
    source = f"testsrc2=size={SIZE[0]}x{SIZE[1]}:rate={FRAME_RATE_HZ}"
    command = f"ffmpeg -v error -f lavfi -i {source} -frames:v {NUM_FRAMES} -c:v libx264 "
    command += f"-pix_fmt yuv420p -movflags +faststart {picture}"
    subprocess.run(command.split(), check=True)
    rows = [_write_clip(directory, picture.read_bytes(), clip) for clip in clips]
    columns = list(dict.fromkeys(column for row in rows for column in row))
    with (directory / "manifest.csv").open("w", newline="") as manifest:
        writer = csv.DictWriter(manifest, columns, restval="")
        writer.writeheader()
        writer.writerows(rows)
    (directory / "set.json").write_text(json.dumps({"schema": 1, "name": name}))
    return directory


def write_example_set(directory: Path, set_file: Path) -> Path:
    """The clips that a set file names, with their factors."""
    clips = [
        {
            "stimulus": stimulus.id,
            "scene": stimulus.scene,
            "role": stimulus.role,
            "seed": stimulus.seed,
            "reference": stimulus.reference,
            **{f"factor_{name}": level for name, level in stimulus.levels.items()},
        }
        for stimulus in expand(load_set(set_file))
    ]
    return write_set(directory, set_file.stem, clips)


def _write_clip(directory: Path, picture: bytes, clip: Mapping[str, Any]) -> dict[str, Any]:
    name = str(clip["stimulus"]).encode()
    content = picture + struct.pack(">I4s", 8 + len(name), b"free") + name
    file = directory / f"{clip['stimulus']}.mp4"
    file.write_bytes(content)
    sha256 = hashlib.sha256(content).hexdigest()
    file.with_suffix(".json").write_text(json.dumps({"video_sha256": sha256}))
    return {
        "method": "seed",
        "seed": 1,
        "reference": "",
        **clip,
        "file": file.name,
        "sha256": sha256,
        "num_bytes": len(content),
        "width_px": SIZE[0],
        "height_px": SIZE[1],
        "frame_rate_hz": FRAME_RATE_HZ,
        "num_frames": NUM_FRAMES,
        "duration_s": NUM_FRAMES / FRAME_RATE_HZ,
        "content_key": sha256[:16],
    }
