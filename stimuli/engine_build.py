# SPDX-License-Identifier: MIT
"""Which engine makes the clips: its version and the hash of the code that runs."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path


@cache
def engine_build() -> dict[str, str]:
    """{version, build}; build = sha256 over the compiled module and the Python that drives it."""
    from verisim import __version__, _engine, clip, engine

    digest = hashlib.sha256()
    for module in (_engine, engine, clip):
        digest.update(hashlib.sha256(Path(str(module.__file__)).read_bytes()).digest())
    return {"version": __version__, "build": digest.hexdigest()}
