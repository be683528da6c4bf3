# SPDX-License-Identifier: MIT
"""Fixtures of the study tests: tiny real clips, a small study, and a server in its own process."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from study_tools import Server, build_stimuli, write_study


@pytest.fixture(scope="session")
def set_dir(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A stimulus directory with six clips of two scenes, one practice and one catch clip."""
    directory = tmp_path_factory.mktemp("stimuli") / "mini"
    build_stimuli(directory)
    return directory


@pytest.fixture(scope="session")
def study_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_study(tmp_path_factory.mktemp("study"))


@pytest.fixture(scope="module")
def server(
    set_dir: Path, study_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Server]:
    """A server that the tests of one file share."""
    db = tmp_path_factory.mktemp("db") / "study.db"
    with Server(study_path, set_dir, db) as running:
        yield running
