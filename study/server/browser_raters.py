# SPDX-License-Identifier: MIT
"""Scripted raters in a real Chromium, visit after visit; a broken run goes on where it was."""

from __future__ import annotations

import json
import random
import secrets
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sqlalchemy import select

from verisim.study.problems import refuse
from verisim.study.server import tables
from verisim.study.server.database import Place, reading_engine
from verisim.study.server.http_client import HttpClient
from verisim.study.server.judge import Judge, look_at_clips
from verisim.study.server.kiosk import find_browser
from verisim.study.server.observer import Traits
from verisim.study.server.run_server import serving_in_background
from verisim.study.server.study_file import load_study

if TYPE_CHECKING:
    from playwright.sync_api import ConsoleMessage, Page, Request, ViewportSize

WINDOW: ViewportSize = {"width": 1280, "height": 720}
FLAGS = ("--disable-gpu", "--disable-background-networking", "--no-first-run")
MAX_COMPLAINTS_SHOWN = 5


@dataclass(frozen=True)
class VisitReport:
    """One visit, as it went."""

    rater: int
    num_forms: int
    took_s: float


OnVisit = Callable[[VisitReport], None]


def simulate_in_browser(
    study: Path,
    set_dir: Path,
    db: Place,
    participants: int,
    seed: int,
    *,
    traits: Traits | None = None,
    on_progress: Callable[[int, int], None] = lambda _done, _total: None,
    on_visit: OnVisit = lambda _report: None,
) -> None:
    """Lets `participants` scripted raters take the whole study on its page in Chromium.

    The raters of `simulate` with the same seed: they see what clips achieved, and their data carry
    source `simulated`. A rater that this database already has completed is not sent again; what a
    broken run left half done stays as an abandoned session, and its rater starts anew. Raises
    StudyError where serving would, where there is no Playwright or Chromium, and where a page
    complains: an exception, an error on its console, a request to anywhere else. on_progress is
    told forms: done and in all.
    """
    if participants < 1:
        raise refuse("participants", f"{participants} is not allowed", "give a number from 1")
    try:
        from playwright.sync_api import sync_playwright

        from verisim.study.server.page_rater import PageRater
    except ImportError as error:
        hint = "pip install 'verisim[browser]'"
        raise refuse("browser", f"Playwright is not installed: {error}", hint) from error
    loaded = load_study(study)
    seen = look_at_clips(loaded, set_dir, traits)
    chromium = find_browser()
    key = secrets.token_urlsafe(32)
    with (
        serving_in_background(study, set_dir, db, 0, simulate_key=key) as address,
        sync_playwright() as playwright,
        playwright.chromium.launch(executable_path=chromium, args=FLAGS) as browser,
    ):
        completed = completed_raters(db, seed)
        with HttpClient(address) as client:
            asked = client.get("/api/study")
        forms_each = asked["num_practice"] + asked["num_trials"] + bool(asked["end_questions"])
        for rater in range(participants):
            on_progress(rater * forms_each, participants * forms_each)
            if rater in completed:
                continue
            begun = time.monotonic()
            rng = random.Random(f"{seed}:{rater}")
            with browser.new_context(viewport=WINDOW) as profile:
                page = profile.new_page()
                complaints: list[str] = []
                listen(page, address, complaints)
                page.goto(f"{address}/?source=simulated&simulate_key={key}")
                visit = PageRater(page, address, loaded.name, Judge(loaded, seen, rng, traits))
                num_forms = 0
                for num_forms in visit.take_part({"browser_seed": seed, "browser_rater": rater}):
                    on_progress(rater * forms_each + num_forms, participants * forms_each)
            if complaints:
                shown = "; ".join(complaints[:MAX_COMPLAINTS_SHOWN])
                raise refuse("simulate", f"the page complained to rater {rater}: {shown}")
            on_visit(VisitReport(rater, num_forms, time.monotonic() - begun))
        on_progress(participants * forms_each, participants * forms_each)


def completed_raters(db: Place, seed: int) -> set[int]:
    """Returns the numbers of the raters of this seed whose visits are complete."""
    statement = (
        select(tables.event.c.detail_json)
        .join(tables.session, tables.session.c.session_id == tables.event.c.session_id)
        .join(
            tables.participant,
            tables.participant.c.participant_id == tables.session.c.participant_id,
        )
        .where(
            tables.event.c.kind == "observer",
            tables.participant.c.source == "simulated",
            tables.participant.c.state == "completed",
        )
    )
    engine = reading_engine(db)
    try:
        with engine.begin() as connection:
            details = [json.loads(text or "{}") for text in connection.scalars(statement)]
    finally:
        engine.dispose()
    return {it["browser_rater"] for it in details if it.get("browser_seed") == seed}


def listen(page: Page, address: str, complaints: list[str]) -> None:
    """Collects what a page must not do."""

    def on_console(said: ConsoleMessage) -> None:
        if said.type in ("error", "warning"):
            complaints.append(said.text)

    def on_request(request: Request) -> None:
        if not request.url.startswith((address, "blob:", "data:")):
            complaints.append(f"a request to {request.url}")

    page.on("console", on_console)
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("request", on_request)
