# SPDX-License-Identifier: MIT
"""Worker processes: every task is answered, and a crash costs one task only."""

from __future__ import annotations

import os
import signal

from verisim.stimuli.workers import Report, TaskEvent, run_tasks


def work(task: str, report: Report) -> str:
    """Does what the task says; importable by name, as workers need it."""
    report(0.5)
    if task == "raise":
        raise ValueError("no such thing")
    if task == "crash":
        os.kill(os.getpid(), signal.SIGSEGV)
    if task == "exit":
        os._exit(3)
    if task == "threads":
        return os.environ["LP_NUM_THREADS"]
    return task.upper()


def last_events(tasks: list[str], num_workers: int) -> list[TaskEvent]:
    ends: dict[int, TaskEvent] = {}
    for event in run_tasks(tasks, work, num_workers):
        if event.kind in ("done", "failed"):
            assert event.index not in ends
            ends[event.index] = event
    return [ends[i] for i in range(len(tasks))]


def test_every_task_is_answered_whatever_happens_to_the_others() -> None:
    events = last_events(["a", "raise", "crash", "b", "exit", "c"], 2)
    assert [event.value for event in events if event.kind == "done"] == ["A", "B", "C"]
    failed = {event.index: event.value for event in events if event.kind == "failed"}
    assert failed[1] == "ValueError: no such thing"
    assert "SIGSEGV" in failed[2]
    assert "exit code 3" in failed[4]


def test_a_worker_tells_the_rasteriser_to_stay_on_one_core() -> None:
    (event,) = last_events(["threads"], 4)
    assert event.value == "0"


def test_events_tell_when_a_task_starts_and_how_far_it_is() -> None:
    kinds = [event.kind for event in run_tasks(["a"], work, 1)]
    assert kinds == ["started", "fraction", "done"]


def test_no_tasks_start_no_workers() -> None:
    assert list(run_tasks([], work, 4)) == []
