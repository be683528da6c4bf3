# SPDX-License-Identifier: MIT
"""Takes part in a study on its page: reads screens, watches clips, answers as its judge says."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from playwright.sync_api import Locator, Page

from verisim.study.problems import refuse
from verisim.study.server.http_client import HttpClient
from verisim.study.server.judge import Judge
from verisim.study.server.questions import Answer, Question

# What can be on the page and wants something, in the order in which it is looked for.
SCREENS = {
    "form": "form.questions:not(.is-saving):not([inert])",
    "consent": "button[data-choice='1']",
    "card": ".calibration .primary",
    "distance": "form.distance",
    "text": ".text .primary:enabled, .message:not(.end):not([role]) .primary:enabled",
    "end": ".end",
}
WAIT_MS = 120_000  # between two screens: clips, and their way here, take their time
MAX_SAME = 6  # so often the same screen in a row is no progress
CARD_PX = 324  # 85.6 mm at 96 CSS px per inch
EVENT_NUMBER = 1_000_000  # beyond those that the page counts for itself


class PageRater:
    """One visit by one scripted rater."""

    def __init__(self, page: Page, address: str, study_name: str, judge: Judge) -> None:
        page.set_default_timeout(WAIT_MS)
        self._page = page
        self._address = address
        self._session_key = f"verisim session {study_name}"
        self._judge = judge

    def take_part(self, about: dict[str, Any]) -> Iterator[int]:
        """Goes from consent to thanks; yields the number of forms answered, after each.

        about: stored with the rater's traits as an `observer` event. Raises StudyError where the
        visit ends in any other way, and where the same screen comes again and again.
        """
        num_forms = num_same = 0
        before = ""
        while (screen := self._wait_for_screen()) != "end":
            title = self._page.get_by_role("heading").first.inner_text()
            num_same = num_same + 1 if screen != "form" and title == before else 0
            before = title
            if num_same == MAX_SAME:
                raise refuse("simulate", f"the page shows {title!r} again and again")
            if screen == "form":
                self._answer(about if num_forms == 0 else None)
                num_forms += 1
                yield num_forms
            else:
                self._pass(screen)
        with self._client() as client:
            step = client.get("/api/next")["step"]
        if step != "thanks":
            raise refuse("simulate", f"a rater ended at {step!r} instead of thanks")

    def _wait_for_screen(self) -> str:
        self._page.locator(", ".join(SCREENS.values())).first.wait_for()
        return next(name for name, it in SCREENS.items() if self._page.locator(it).count())

    def _pass(self, screen: str) -> None:
        """Presses on; returns when the button has gone."""
        button = SCREENS[screen]
        if screen == "consent":
            button = "button[data-choice='0']"
        elif screen == "card":
            self._size_card()
        elif screen == "distance":
            with self._client() as client:
                distance_mm = client.get("/api/study")["screen"]["distance_mm"]["usual"]
            self._page.locator("#distance-cm").fill(f"{distance_mm / 10:g}")
            button = "form.distance .primary"
        pressed = self._page.locator(button).first.element_handle()
        pressed.click()
        pressed.wait_for_element_state("hidden")

    def _size_card(self) -> None:
        """Makes the drawn card as wide as a card on a screen of 96 CSS px per inch."""
        edge = self._page.locator(".card-edge")
        while (short_px := CARD_PX - int(edge.get_attribute("aria-valuenow") or "0")) > 0:
            edge.press("PageUp" if short_px >= 20 else "ArrowRight")

    def _client(self) -> HttpClient:
        """Returns a line to the server in this visit's name."""
        saved = self._page.evaluate("(key) => localStorage.getItem(key)", self._session_key)
        return HttpClient(self._address, json.loads(saved)["token"])

    def _answer(self, about: dict[str, Any] | None) -> None:
        """Answers the form on the page and sends it."""
        self._page.locator(".stage").wait_for(state="detached")
        with self._client() as client:
            if about is not None:
                event = {
                    "seq": EVENT_NUMBER,
                    "presentation_id": None,
                    "kind": "observer",
                    "t_ms": 0,
                    "detail": self._judge.describe() | about,
                }
                client.post("/api/events", events=[event])
            step = client.get("/api/next")
        trial = step["trial"]
        judged = self._judge.judge_trial(trial) if trial else self._judge.judge_session()
        for question, answers in judged:
            for item, answer in answers.items():
                give_answer(self._page, question, item, answer)
        # This form's end is waited for, not that there is none: the next may come at once.
        form = self._page.locator("form.questions").element_handle()
        self._page.locator("form.questions > .buttons .primary").click()
        form.wait_for_element_state("hidden")


def give_answer(page: Page, question: Question, item: str, answer: Answer) -> None:
    """Answers one item of a question with mouse and keys."""
    field = page.locator(f".question:has(#prompt-{question.key})")
    if question.kind == "slider":
        assert answer.value is not None
        move_slider(page, field.get_by_role("slider"), round(answer.value))
    elif question.kind == "comment":
        field.get_by_role("textbox").fill(answer.value_text or "")
    elif question.kind == "mark":
        if answer.value is None:
            field.locator(".mark-buttons button").nth(1).click()
        else:
            mark(page, field, answer.value)
    else:
        name = f"answer-{question.key}" + (f"-{item}" if item else "")
        value = answer.value_text if answer.value_text is not None else f"{answer.value:g}"
        field.locator(f"[name='{name}'][value='{value}']").check()


def move_slider(page: Page, track: Locator, value: int) -> None:
    """Presses near the value, then steps to it."""
    line = track.locator(".track-line")
    line.scroll_into_view_if_needed()
    box = line.bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + value / 100 * box["width"], box["y"] + box["height"] / 2)
    while (seen := int(track.get_attribute("aria-valuenow") or "0")) != value:
        track.press("ArrowRight" if seen < value else "ArrowLeft")


def mark(page: Page, field: Locator, time_ms: float) -> None:
    """Plays the clip again and pauses it at about this time."""
    field.locator(".mark-buttons button").first.click()
    buttons = page.locator(".stage-panel button")
    buttons.first.wait_for()  # "pause": the clip has been wound back and plays
    page.locator(".stage video").first.evaluate(
        """(video, at) => new Promise((resolve) => {
            const look = () => video.currentTime >= at || video.paused
                ? (video.pause(), resolve()) : requestAnimationFrame(look);
            look();
        })""",
        time_ms / 1000,
    )
    buttons.nth(1).wait_for()  # earlier, later, mark, …
    page.locator(".stage-panel .primary").click()
    page.locator(".stage").wait_for(state="detached")
