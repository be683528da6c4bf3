# SPDX-License-Identifier: MIT
"""A participant at the page: reads screens, watches clips, answers, remembers what was answered."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from playwright.sync_api import Page

FORM = "form.questions:not(.is-saving):not([inert])"
TEXT_SCREEN = (
    ".jspsych-btn-group-flex button:enabled, .message:not(.end):not([role]) .primary:enabled"
)

# Again and again, for an answer can bring up questions and take others away.
ANSWER_ALL = """(choice) => {
    const answered = new Set();
    const form = document.querySelector('form.questions');
    const open = () => [...form.querySelectorAll('[role=radiogroup], .track, textarea')]
        .find((it) => !answered.has(it) && it.checkVisibility());
    for (let it = open(); it; it = open()) {
        answered.add(it);
        if (it.matches('[role=radiogroup]')) it.querySelectorAll('input')[choice].click();
        else if (it.matches('.track')) {
            const key = choice ? 'End' : 'Home';
            it.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true}));
        } else {
            it.value = `comment ${choice}`;
            it.dispatchEvent(new InputEvent('input', {bubbles: true}));
        }
    }
}"""


class Participant:
    def __init__(self, page: Page) -> None:
        self.page = page
        self.given: list[dict[str, Any]] = []

    def press(self, name: str) -> None:
        self.page.get_by_role("button", name=name).click()

    def wait_for_heading(self, text: str) -> None:
        self.page.get_by_role("heading", name=text).wait_for()

    def wait_for_questions(self) -> None:
        self.page.locator(FORM).wait_for()
        self.page.locator(".stage").wait_for(state="detached")

    def wait_for_clip(self) -> None:
        """Returns while a clip plays."""
        self.page.locator(".stage video").evaluate(
            """(video) => new Promise((resolve) => {
                const look = () => video.currentTime > 0 ? resolve() : requestAnimationFrame(look);
                look();
            })"""
        )

    def come_to_first_clip(self) -> None:
        self.press("I agree to take part")
        self.press("Begin")
        self.wait_for_heading("Practice first")
        self.press("Continue")

    def come_to_questions(self) -> None:
        self.come_to_first_clip()
        self.wait_for_questions()

    def answer(self, i: int) -> None:
        """Fills the form with answers that differ from trial to trial."""
        chosen: dict[str, Any] = {
            "realism": 1 + i % 7,
            "speed": 1 + (i + 2) % 5,
            "fun": 10 * ((i + 3) % 10),
        }
        for key in ("realism", "speed"):
            self.page.locator(f"[name=answer-{key}][value='{chosen[key]}']").check()
        self.page.get_by_role("slider").press(str(chosen["fun"] // 10))
        if i % 2:
            chosen["why"] = f"Comment {i}: ça glisse 🦊\nsecond line"
            self.page.get_by_role("textbox").fill(chosen["why"])
        self.given.append(chosen)

    def answer_anything(self, choice: int = 0) -> None:
        """Answers every question on the page at once; choice: position within each group."""
        self.page.evaluate(ANSWER_ALL, choice)

    def submit(self, button: str = "Continue") -> None:
        """Sends this form and returns when it has gone; the next one may be there by then."""
        form = self.page.locator(FORM).element_handle()
        self.press(button)
        form.wait_for_element_state("hidden")

    def wait_for_screen(self) -> str:
        """Waits for the next screen that wants something: 'questions', 'text' or 'thanks'."""
        screens = {"questions": FORM, "text": TEXT_SCREEN, "thanks": ".end"}
        self.page.locator(", ".join(screens.values())).first.wait_for()
        return next(name for name, it in screens.items() if self.page.locator(it).count())

    def finish(self, first: int = 0, answer: Callable[[int], None] | None = None) -> str:
        """Answers everything that comes and returns the completion code."""
        i = first
        while (screen := self.wait_for_screen()) != "thanks":
            if screen == "text":
                title = self.page.get_by_role("heading").first.inner_text()
                self.page.locator(TEXT_SCREEN).first.click()
                self.page.get_by_role("heading", name=re.escape(title)).wait_for(state="detached")
            else:
                self.wait_for_questions()
                (answer or self.answer)(i)
                self.submit()
                i += 1
        return self.page.locator(".code").inner_text()

    def go_through(self) -> None:
        """Takes part in a study without a screen check, from consent to the last page."""
        num_forms = 0
        screens = {"form": FORM, "consent": "button[data-choice='1']", "text": TEXT_SCREEN}
        while True:
            self.page.locator(", ".join([*screens.values(), ".end"])).first.wait_for()
            if self.page.locator(".end").count():
                return
            screen = next(it for it, where in screens.items() if self.page.locator(where).count())
            if screen == "form":
                self.wait_for_questions()
                self.answer_anything(num_forms % 2)
                self.submit()
                num_forms += 1
                continue
            button = "button[data-choice='0']" if screen == "consent" else TEXT_SCREEN
            pressed = self.page.locator(button).first.element_handle()
            pressed.click()
            pressed.wait_for_element_state("hidden")

    def num_undelivered(self) -> int:
        """Letters in the browser's outbox."""
        count = """() => new Promise((resolve) => {
            const opening = indexedDB.open('verisim outbox mini');
            opening.onsuccess = () => {
                const db = opening.result;
                const counting = db.transaction('letters').objectStore('letters').count();
                counting.onsuccess = () => { db.close(); resolve(counting.result); };
            };
        })"""
        return int(self.page.evaluate(count))
