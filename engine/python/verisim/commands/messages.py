# SPDX-License-Identifier: MIT
"""What commands say: data to stdout, messages and progress to stderr."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NoReturn

import typer
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from verisim.json_numbers import finite_numbers

Report = Callable[[float, float], None]

console = Console(stderr=True, highlight=False)


def is_user_error(error: Exception) -> bool:
    """Whether the message is for the user: our own exceptions, and what files and disks refuse."""
    return isinstance(error, OSError) or type(error).__module__.startswith("verisim.")


def fail(message: str, *, code: int = 1) -> NoReturn:
    """Prints the message to stderr and ends with this exit status."""
    print(f"verisim: {message}", file=sys.stderr)
    sys.exit(code)


def say(message: str) -> None:
    """One line for people, to stderr."""
    print(message, file=sys.stderr, flush=True)


def print_json(value: dict[str, Any]) -> None:
    """One JSON object to stdout. Numbers that are not finite become null: JSON has none."""
    typer.echo(json.dumps(finite_numbers(value), ensure_ascii=False, allow_nan=False))


@contextmanager
def progress_bar(words: str, *, counts: bool = False) -> Iterator[Report]:
    """A bar on stderr with time left; yields report(done, total). Silent when not a terminal."""
    columns = [TextColumn("{task.description}"), BarColumn(), TaskProgressColumn()]
    if counts:
        columns.append(MofNCompleteColumn())
    columns += [TimeElapsedColumn(), TextColumn("left"), TimeRemainingColumn()]
    with Progress(
        *columns, console=console, transient=True, disable=not console.is_terminal
    ) as bar:
        task = bar.add_task(words, total=None)

        def report(done: float, total: float) -> None:
            bar.update(task, completed=done, total=total)

        yield report
