# SPDX-License-Identifier: MIT
"""The command line, in an empty folder."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

Command = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture
def bench(tmp_path: Path) -> Command:
    """Runs `verisim bench`: arguments -> completed process."""

    def run(*arguments: object, timeout: float = 250) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "verisim", "bench", *map(str, arguments)],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=timeout,
            check=False,
        )

    return run
