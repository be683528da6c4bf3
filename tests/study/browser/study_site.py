# SPDX-License-Identifier: MIT
"""A mini study on a real server that can be killed, and browser profiles that visit it."""

from __future__ import annotations

import atexit
import multiprocessing
import shutil
import socket
import sqlite3
import tempfile
import time
import urllib.request
from functools import cache
from multiprocessing.context import ForkServerProcess
from pathlib import Path
from typing import Any

from page_participant import Participant
from playwright.sync_api import BrowserContext, Page

from verisim.study.server import serve
from verisim.study.server.database import prepare_database

WEB = Path(__file__).resolve().parents[3] / "study" / "web"
SIMULATE_KEY = "browser-test-key"

STUDY = """\
schema: 1
name: mini
title: Does it move like the real thing?
contact: nobody@example.org
set: mini
languages: [en]
consent: consent.md
instructions: instructions.md
thanks: thanks.md
trial: {layout: single, lock: first_play, replays: 1, fixation_ms: [50, 100], rest_every: 2}
questions:
  - {key: realism, kind: rating, points: 7, prompt: {en: How real was it?}, ends: {en: [not, very]}}
  - {key: speed, kind: bipolar, points: 5, prompt: {en: How fast was it?},
     ends: {en: [too slow, too fast]}, middle: {en: just right}}
  - {key: fun, kind: slider, prompt: {en: Was it fun?}, ends: {en: [no fun, great fun]}}
  - {key: why, kind: comment, max_chars: 200, prompt: {en: What did you notice?}}
order: {sampler: random, seed: 7}
analysis: {primary: realism}
"""
TEXTS = {
    "consent.md": "# {title}\n\nYou watch clips and rate them.\n\nVersion: 1\n",
    "instructions.md": "# How it works\n\n1. Watch the clip.\n2. Answer.\n",
    "thanks.md": "# Thank you\n\nKeep this code. Questions: {contact}.\n",
}
# Servers are forked from one process that has imported the server: that spares 1.6 s of CPU each.
FORKS = multiprocessing.get_context("forkserver")
FORKS.set_forkserver_preload(["verisim.study.server.run_server"])


@cache
def empty_database() -> Path:
    """A database with tables and no rows, to start from: that spares each server 0.4 s of CPU."""
    folder = tempfile.TemporaryDirectory(prefix="verisim-")
    atexit.register(folder.cleanup)
    database = Path(folder.name) / "empty.db"
    prepare_database(database)
    return database


class StudyServer:
    """The study server in a process of its own, which can be killed and started again."""

    def __init__(self, folder: Path, clips: Path, study: str = STUDY, **settings: Any) -> None:
        self.settings = {"simulate_key": SIMULATE_KEY, **settings}
        self.study = folder / "mini.yaml"
        self.study.write_text(study)
        for name, text in TEXTS.items():
            (folder / name).write_text(text)
        self.clips = clips
        self.db = folder / "study.db"
        shutil.copy(empty_database(), self.db)
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.address = f"http://127.0.0.1:{self.port}"
        self.process: ForkServerProcess | None = None

    def start(self) -> None:
        self.process = FORKS.Process(
            target=serve,
            args=(self.study, self.clips, self.db),
            kwargs={"port": self.port, **self.settings},
        )
        self.process.start()
        for _ in range(200):
            try:
                urllib.request.urlopen(f"{self.address}/readyz", timeout=2).close()
                return
            except OSError:
                assert self.process.is_alive(), "the study server ended"
                time.sleep(0.05)
        raise AssertionError("the study server did not start within 10 s")

    def kill(self) -> None:
        """Ends the process as a power cut would: no goodbye, no flush."""
        if self.process:
            self.process.kill()
            self.process.join()
            self.process = None

    def rows(self, sql: str) -> list[dict[str, Any]]:
        with sqlite3.connect(self.db) as connection:
            connection.row_factory = sqlite3.Row
            return [dict(row) for row in connection.execute(sql)]

    def change(self, sql: str) -> None:
        with sqlite3.connect(self.db) as connection:
            connection.execute(sql)

    def answers(self) -> list[dict[str, Any]]:
        """What the database holds, one dict of answers per answered trial, in the order shown."""
        found: dict[int, dict[str, Any]] = {}
        for row in self.rows(
            "SELECT t.trial_index, q.key, r.value FROM response r JOIN trial t USING (trial_id) "
            "JOIN question q USING (question_id) "
            "UNION ALL SELECT t.trial_index, q.key, c.body FROM comment c "
            "JOIN trial t USING (trial_id) JOIN question q USING (question_id)"
        ):
            found.setdefault(row["trial_index"], {})[row["key"]] = row["value"]
        return [found[i] for i in sorted(found)]


def watch(page: Page, address: str, complaints: list[str]) -> None:
    """Collects what a page must not do: console errors, exceptions, requests to anywhere else."""
    page.set_default_timeout(20_000)
    page.on(
        "console",
        lambda said: complaints.append(said.text) if said.type in ("error", "warning") else None,
    )
    page.on("pageerror", lambda error: complaints.append(str(error)))

    def check(url: str) -> None:
        if not url.startswith((address, "blob:", "data:")):
            complaints.append(f"external request: {url}")

    page.on("request", lambda request: check(request.url))


SIMULATED = f"?source=simulated&simulate_key={SIMULATE_KEY}"


class Visit:
    """One browser profile visiting one study."""

    def __init__(self, context: BrowserContext, server: StudyServer) -> None:
        self.context = context
        self.server = server
        self.complaints: list[str] = []

    def open(self, query: str = SIMULATED) -> Participant:
        page = self.context.new_page()
        watch(page, self.server.address, self.complaints)
        page.goto(self.server.address + "/" + query)
        return Participant(page)
