# SPDX-License-Identifier: MIT
"""A few long-lived worker processes that survive each other: one task's crash costs that task."""

from __future__ import annotations

import multiprocessing
import os
import signal
import traceback
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any

Report = Callable[[float], None]  # share of the task that is done, 0 … 1
Work = Callable[[Any, Report], Any]

_SPAWN = multiprocessing.get_context("spawn")  # a forked OpenGL or thread state is undefined


@dataclass(frozen=True)
class TaskEvent:
    """What happened to one task."""

    index: int
    kind: str  # started | fraction | done | failed
    value: Any = None  # the share done, the result, or the message


@dataclass
class _Worker:
    process: BaseProcess
    pipe: Connection
    index: int | None = None  # task in work


def run_tasks(tasks: Sequence[Any], work: Work, num_workers: int) -> Iterator[TaskEvent]:
    """Runs `work(task, report)` for every task in worker processes and yields events.

    `work` must be importable by name. An exception or a crash gives a `failed` event for its task
    only. Closing the iterator, or Ctrl-C, ends the workers.
    """
    waiting = list(range(len(tasks)))[::-1]
    workers = [_start(work) for _ in range(min(num_workers, len(tasks)))]
    try:
        for worker in workers:
            yield _give(worker, tasks, waiting)
        while any(worker.index is not None for worker in workers):
            busy = {w.pipe: w for w in workers if w.index is not None}
            for pipe in wait(list(busy)):
                worker = busy[pipe]  # type: ignore[index]
                index = worker.index
                assert index is not None
                try:
                    kind, value = worker.pipe.recv()
                except (EOFError, OSError):
                    worker.process.join()
                    kind, value = "failed", _last_words(worker.process.exitcode)
                    workers[workers.index(worker)] = worker = _start(work)
                    worker.index = index
                if kind != "fraction":
                    worker.index = None
                yield TaskEvent(index, kind, value)
                if worker.index is None and waiting:
                    yield _give(worker, tasks, waiting)
    finally:
        for worker in workers:
            worker.process.terminate()
            worker.process.join()
            worker.pipe.close()


def _start(work: Work) -> _Worker:
    ours, theirs = _SPAWN.Pipe()
    process = _SPAWN.Process(target=_serve, args=(theirs, work), daemon=True)
    process.start()
    theirs.close()
    return _Worker(process, ours)


def _give(worker: _Worker, tasks: Sequence[Any], waiting: list[int]) -> TaskEvent:
    worker.index = waiting.pop()
    worker.pipe.send(tasks[worker.index])
    return TaskEvent(worker.index, "started")


def _serve(pipe: Connection, work: Work) -> None:
    """The worker's loop."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to handle
    os.environ["LP_NUM_THREADS"] = "0"  # one core per worker; read when OpenGL starts
    while True:
        try:
            task = pipe.recv()
        except EOFError:
            return
        try:
            pipe.send(("done", work(task, lambda share: pipe.send(("fraction", share)))))
        except Exception as error:
            text = str(error) or traceback.format_exc()
            pipe.send(("failed", f"{type(error).__name__}: {text}"))


def _last_words(exit_code: int | None) -> str:
    if exit_code is not None and exit_code < 0:
        name = signal.Signals(-exit_code).name
        return f"the worker process was ended by {name}" + (
            "; it may have run out of memory" if name == "SIGKILL" else ""
        )
    return f"the worker process ended with exit code {exit_code}"
