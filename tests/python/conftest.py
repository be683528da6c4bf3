# SPDX-License-Identifier: MIT
"""Scenes and the command line, as a user has them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from command_line import Command

BOUNCE = """\
schema: 1
name: bounce
duration_s: 0.5
frame_rate_hz: 60
materials: {rubber: {density_kg_m3: 1000}}
bodies:
  - {name: ball, shape: {sphere_radius_m: 0.1}, material: rubber, position_m: [0, 0, 0.4]}
ground: {plane: {normal: [0, 0, 1], offset_m: 0}, material: rubber}
physics: {method: seed, dt_s: 1e-4, stiffness_n_m: 2e4, damping_ratio: 0}
"""


@pytest.fixture
def bounce(tmp_path: Path) -> Path:
    """A ball that falls 0.3 m onto an elastic floor."""
    file = tmp_path / "bounce.yaml"
    file.write_text(BOUNCE)
    return file


@pytest.fixture
def verisim(tmp_path: Path) -> Command:
    """Runs the verisim command in an empty folder: arguments -> completed process."""

    def run(*arguments: object, timeout: float = 60) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "verisim", *map(str, arguments)],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=timeout,
            check=False,
        )

    return run
