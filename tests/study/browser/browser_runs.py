# SPDX-License-Identifier: MIT
"""Scripted raters in a browser, run beside a record of what they judged."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest.mock import patch

from playwright.sync_api import Page

from verisim.study.server import page_rater, simulate_in_browser
from verisim.study.server.browser_raters import VisitReport
from verisim.study.server.questions import Answer, Question

Given = tuple[str, str, float | None, str | None]  # question, item, value, text


@dataclass
class Run:
    study: Path
    clips: Path
    db: Path
    judged: list[Given] = field(default_factory=list)
    visits: list[VisitReport] = field(default_factory=list)
    progress: list[tuple[int, int]] = field(default_factory=list)

    def rows(self, sql: str) -> list[Any]:
        with sqlite3.connect(self.db) as connection:
            return connection.execute(sql).fetchall()

    def stored(self, where: str = "true") -> list[Given]:
        """Every answer in the database to trials like this; times of marks left out."""
        return in_order(
            (key, item, None if item == "m1" else value, text)
            for key, item, value, text in self.rows(
                "SELECT key, item, value, coalesce(value_text, '') FROM response "
                f"JOIN question USING (question_id) WHERE {where} UNION ALL "
                "SELECT key, '', NULL, body FROM comment JOIN question USING (question_id) "
                f"WHERE {where} UNION ALL SELECT key, item, value, coalesce(value_text, '') "
                "FROM session_answer JOIN question USING (question_id)"
            )
        )


def in_order(given: Iterable[Given]) -> list[Given]:
    return sorted(given, key=str)


def in_own_thread(act: Callable[[], None]) -> None:
    """Runs something that starts a Playwright of its own: a thread can hold only one."""
    with ThreadPoolExecutor(1) as pool:
        pool.submit(act).result()


def run_raters(run: Run, num: int) -> None:
    """Runs the raters and notes each answer on its way into the page."""
    give = page_rater.give_answer

    def note(page: Page, question: Question, item: str, answer: Answer) -> None:
        value = None if item == "m1" else answer.value
        run.judged.append((question.key, item, value, answer.value_text or ""))
        give(page, question, item, answer)

    with patch.object(page_rater, "give_answer", note):
        in_own_thread(
            lambda: simulate_in_browser(
                run.study,
                run.clips,
                run.db,
                num,
                seed=5,
                on_progress=lambda *step: run.progress.append(step),
                on_visit=run.visits.append,
            )
        )
