# SPDX-License-Identifier: MIT
"""Fixtures shared by the analysis tests: a sound export, written once per run."""

from __future__ import annotations

from pathlib import Path

import pytest
from make_export import make_tree

from verisim.analysis import analyse


@pytest.fixture(scope="session")
def sound_export(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An export tree without a fault: 12 simulated raters, 12 clips, 4 questions and comments."""
    return make_tree().write(tmp_path_factory.mktemp("sound") / "export")


@pytest.fixture(scope="session")
def analysed(sound_export: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The whole analysis of the sound export."""
    out = tmp_path_factory.mktemp("analysed") / "out"
    analyse(sound_export, out)
    return out
