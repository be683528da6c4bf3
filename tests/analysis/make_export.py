# SPDX-License-Identifier: MIT
"""Writes small export trees for the tests, seeded, by the rules of `verisim export`."""

from __future__ import annotations

import csv
import hashlib
import io
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from verisim.analysis.columns import TABLES

Row = dict[str, Any]
UTC = "2026-03-01T09:00:00Z"
SCENES = {
    "bounce": ("1e3", "1e4", "1e5"),
    "collide": ("1e3", "1e4", "1e5"),
    "fox_tumble": ("1e3", "1e4", "1e5"),
    "box_stack": ("1e2", "1e3", "1e5"),
}
REMARKS = ("The boxes sink into each other", "It looked too slow", "The bounce was fine, really",
           "it jittered at the end", "spins oddly, floats")  # fmt: skip
QUESTIONS = [
    {"key": "collision", "kind": "rating", "points": 7, "prompt": "Did the collision look right?",
     "ends": ["not at all", "completely"]},
    {"key": "rotation", "kind": "rating", "points": 7, "prompt": "Did the rotation look real?",
     "ends": ["not at all", "completely"]},
    {"key": "speed", "kind": "bipolar", "points": 7, "prompt": "Too slow or too fast?",
     "ends": ["too slow", "too fast"]},
    {"key": "fun", "kind": "slider", "min": 0, "max": 100, "prompt": "Was it fun?",
     "ends": ["no", "yes"]},
]  # fmt: skip


@dataclass
class Tree:
    """Rows of every table before they are written; tests change them at will."""

    tables: dict[str, list[Row]] = field(default_factory=dict)
    description: Row = field(default_factory=dict)

    def write(self, root: Path) -> Path:
        """Write description, tables and checksums under `root`."""
        (root / "data").mkdir(parents=True)
        sums = {}
        text = json.dumps(self.description, indent=2)
        (root / "dataset_description.json").write_text(text)
        (root / "README.md").write_text("An export made for tests.\n")
        for name, rows in self.tables.items():
            path = root / "data" / f"study-mini_table-{name}_data.csv"
            path.write_text(csv_text(columns_of(name), rows), newline="")
        for path in sorted(root.rglob("*")):
            if path.is_file():
                relative = path.relative_to(root).as_posix()
                sums[relative] = hashlib.sha256(path.read_bytes()).hexdigest()
        lines = "".join(f"{sha}  {name}\n" for name, sha in sums.items())
        (root / "sha256.txt").write_text(lines)
        return root


def make_tree(num_people: int = 12, source: str = "simulated", seed: int = 1) -> Tree:
    """A sound export of the demo's shape: 4 scenes × 3 stiffnesses, 4 questions and comments."""
    rng = np.random.default_rng(seed)
    tree = Tree({name: [] for name in TABLES}, describe())
    clips = [_add_clip(tree, scene, level, rng) for scene in SCENES for level in SCENES[scene]]
    for number in range(num_people):
        _add_participant(tree, f"P{number + 1:03d}", source, clips, rng)
    return tree


def describe() -> Row:
    """The codebook: every column of every table, and the questions' scales."""
    names = sorted({column for name in TABLES for column in columns_of(name)})
    return {
        "@context": "https://schema.org/",
        "@type": "Dataset",
        "name": "mini",
        "description": "A made-up study for tests.",
        "variableMeasured": [
            {"@type": "PropertyValue", "name": name, "description": name} for name in names
        ],
        "questions": QUESTIONS,
        "study": {"blind": False, "analysis": {"primary": "collision"}},
    }


def columns_of(table: str) -> list[str]:
    """Header of a table, with the factor column where the contract has factor_*."""
    names = list(TABLES[table].columns)
    return [*names, "factor_stiffness"] if table in ("ratings", "stimuli") else names


def csv_text(columns: list[str], rows: list[Row]) -> str:
    """RFC 4180 text with LF."""
    buffer = io.StringIO(newline="")
    writer = csv.DictWriter(buffer, columns, restval="", extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return buffer.getvalue()


def _add_clip(tree: Tree, scene: str, level: str, rng: np.random.Generator) -> Row:
    stimulus = f"{scene}__stiffness-{level}__s1"
    reference = f"{scene}__stiffness-{SCENES[scene][-1]}__s1"
    stiffness = float(level)
    error = 2.0 / stiffness
    failed = scene == "box_stack" and level == "1e2"
    clip = {
        "study": "mini", "source": "stimulus", "stimulus": stimulus, "role": "test", "scene": scene,
        "method": "seed", "seed": 1, "reference": "" if stimulus == reference else reference,
        "factor_stiffness": level, "sha256": _sha(stimulus), "num_bytes": 90_000, "width_px": 1280,
        "height_px": 720, "frame_rate_hz": 60, "num_frames": 180, "duration_s": 3,
        "content_key": _sha("key" + stimulus),
    }  # fmt: skip
    tree.tables["stimuli"].append(clip)
    median = 0.002 * stiffness**0.5 * rng.uniform(0.8, 1.2)
    tree.tables["engine"].append({
        "study": "mini", "source": "stimulus", "stimulus": stimulus, "method": "seed",
        "engine_version": "0.1.0", "scene_sha256": _sha(scene), "state_hash": _sha("s" + stimulus),
        "failed_code": "sank" if failed else "", "failed_body": "top" if failed else "",
        "failed_time_s": 1.25 if failed else "", "dt_s": 1e-4, "stiffness_n_m": stiffness,
        "max_penetration_m": 0 if scene == "collide" and stiffness > 5e4 else error,
        "mean_penetration_m": error / 3,
        "error_to_reference_m": "" if stimulus == reference else error * 4,
        "energy_residual_rel": error**2, "momentum_residual_rel": 1e-12, "num_particles": 400,
        "max_contacts": 60, "cost_machine": "bench-1", "cost_build": "release", "cost_num_runs": 5,
        "cpu_s_per_sim_s_median": median, "cpu_s_per_sim_s_min": median * 0.95,
        "cpu_s_per_sim_s_q1": median * 0.97, "cpu_s_per_sim_s_q3": median * 1.08,
    })  # fmt: skip
    return clip | {"goodness": float(np.log10(stiffness))}


def _add_participant(
    tree: Tree, person: str, source: str, clips: list[Row], rng: np.random.Generator
) -> None:
    who = {"study": "mini", "participant_id": person, "source": source}
    session = f"S-{person}"
    tree.tables["participants"].append(who | {
        "state": "completed", "consent_version": "1", "consent_sha256": _sha("consent"),
        "consent_language": "en", "enrolled_utc": UTC, "consented_utc": UTC, "completed_utc": UTC,
        "num_trials_planned": len(clips), "num_trials_answered": len(clips), "order_seed": "7",
        "order_sha256": _sha(person),
    })  # fmt: skip
    tree.tables["sessions"].append(
        who
        | {"session_id": session, "started_utc": UTC, "browser": "Chromium", "screen_w_px": 1280}
    )
    flagged = int(person == "P002")
    tree.tables["exclusions"].append(
        who | {"rule": "median_rt_below_ms", "value": 900, "limit": 400, "flagged": 0}
    )
    tree.tables["exclusions"].append(
        who | {"rule": "missed_catch", "value": flagged, "limit": 1, "flagged": flagged}
    )
    tree.tables["events"].append(
        who | {"session_id": session, "seq": 0, "kind": "page_hidden", "t_ms": 12}
    )
    bias = rng.normal(0, 0.5)
    for index in rng.permutation(len(clips)):
        _add_showing(tree, who | {"session_id": session}, int(index), clips[index], bias, rng)


def _add_showing(
    tree: Tree, who: Row, index: int, clip: Row, bias: float, rng: np.random.Generator
) -> None:
    shown = who | {
        "presentation_id": f"{who['participant_id']}-{index}", "trial_index": index,
        "trial_kind": "test", "block": "main", "layout": "single", "stimulus": clip["stimulus"],
        "stimulus_sha256": clip["sha256"],
    }  # fmt: skip
    tree.tables["presentations"].append(
        shown | {"completed": 1, "num_plays": 1, "frames_total": 180, "frames_dropped": 0,
                 "stall_count": 0, "stall_ms": 0, "hidden_ms": 0}
    )  # fmt: skip
    answer = shown | {
        "scene": clip["scene"], "method": "seed", "factor_stiffness": clip["factor_stiffness"],
        "rt_ms": 900 + index, "rt_origin": "video_end", "num_plays": 1, "answered_utc": UTC,
    }  # fmt: skip
    level = 1.6 * clip["goodness"] - 2 + bias
    values = {
        "collision": np.clip(round(level + rng.normal(0, 0.8)), 1, 7),
        "rotation": np.clip(round(level + rng.normal(0, 1.4)), 1, 7),
        "speed": np.clip(round(4 - (4 - clip["goodness"]) * 0.6 + rng.normal(0, 0.8)), 1, 7),
        "fun": np.clip(round(50 + rng.normal(0, 20)), 0, 100),
    }
    for question in QUESTIONS:
        key = str(question["key"])
        tree.tables["ratings"].append(
            answer | {"question": key, "question_kind": question["kind"], "value": int(values[key])}
        )
    if rng.random() < 0.3:
        text = REMARKS[int(rng.integers(len(REMARKS)))]
        tree.tables["comments"].append(answer | {"question": "why", "comment": text})


def _sha(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
