# SPDX-License-Identifier: MIT
"""One writer at a time in a folder."""

from __future__ import annotations

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def only_writer(directory: Path, what: str, error: type[Exception]) -> Iterator[None]:
    """Keeps others out of an existing folder; raises `error` if another `what` is writing there."""
    with (directory / ".lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as taken:
            raise error(
                f"{directory}: another {what} is writing here\n"
                "  hint: wait for it, or choose another folder with -o"
            ) from taken
        yield
