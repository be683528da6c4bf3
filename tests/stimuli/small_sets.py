# SPDX-License-Identifier: MIT
"""A small scene and set that build in a blink."""

from __future__ import annotations

from pathlib import Path

BALL_SCENE = """\
schema: 1
name: {name}
duration_s: 0.15
frame_rate_hz: 60
materials: {{rubber: {{density_kg_m3: 500}}}}
bodies:
  - {{name: ball, shape: {{sphere_radius_m: 0.1}}, material: rubber, position_m: [0, 0, 0.15],
     velocity_m_s: [0.5, 0, -1]}}
  - {{name: post, shape: {{sphere_radius_m: 0.1}}, material: rubber, position_m: [1, 0, 0.1],
     motion: fixed}}
ground: {{plane: {{normal: [0, 0, 1], offset_m: 0}}, material: rubber}}
physics: {{method: seed, stiffness_n_m: 5000, dt_s: 1.0e-3, damping_ratio: 0.1}}
"""

BALL_SET = """\
schema: 1
name: small
scenes: [ball]
factors:
  stiffness: {set: physics.stiffness_n_m, levels: {low: 500, high: 5000}, reference: high}
size: 64x64
profile: preview
"""


def write_set(library: Path, text: str) -> Path:
    file = library / "sets" / "small.yaml"
    file.write_text(text)
    return file
