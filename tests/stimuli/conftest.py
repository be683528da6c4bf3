# SPDX-License-Identifier: MIT
"""The folder of scenes and sets that the tests of stimuli use."""

from __future__ import annotations

from pathlib import Path

import pytest
from small_sets import BALL_SCENE, BALL_SET


@pytest.fixture
def library(tmp_path: Path) -> Path:
    """A folder with scenes/ball.yaml, scenes/other.yaml and sets/small.yaml."""
    (tmp_path / "scenes").mkdir()
    (tmp_path / "sets").mkdir()
    for name in ("ball", "other"):
        (tmp_path / "scenes" / f"{name}.yaml").write_text(BALL_SCENE.format(name=name))
    (tmp_path / "sets" / "small.yaml").write_text(BALL_SET)
    return tmp_path
