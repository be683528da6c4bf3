# SPDX-License-Identifier: MIT
"""Every screen passes axe without serious findings, and the keyboard alone is enough."""

from __future__ import annotations

import re

from axe import findings
from page_participant import FORM
from playwright.sync_api import Browser, Route, expect
from study_site import StudyServer, Visit


def test_no_screen_has_serious_axe_findings(visit: Visit, study_server: StudyServer) -> None:
    one = visit.open()
    one.page.get_by_role("button", name="I agree").wait_for()
    found = {"consent": findings(one.page)}
    one.press("I agree to take part")
    one.page.get_by_role("button", name="Begin").wait_for()
    found["instructions"] = findings(one.page)
    one.press("Begin")
    one.wait_for_heading("Practice first")
    found["practice"] = findings(one.page)

    def refuse(route: Route) -> None:
        route.fulfill(status=500)

    one.page.route("**/media/*", refuse)
    one.press("Continue")
    one.wait_for_heading("The clip could not be shown")
    found["clip error"] = findings(one.page)
    one.page.unroute("**/media/*")
    one.press("Try again")
    one.wait_for_questions()
    found["questions"] = findings(one.page)
    one.press("Continue")
    found["missing answers"] = findings(one.page)
    one.answer(0)
    found["answered"] = findings(one.page)
    study_server.kill()
    one.submit()
    one.wait_for_heading("Connection lost")
    found["connection lost"] = findings(one.page)
    assert found == {screen: [] for screen in found}


def test_the_keyboard_alone_is_enough(visit: Visit, study_server: StudyServer) -> None:
    one = visit.open()
    keys = one.page.keyboard

    def press_focused(name: str) -> None:
        """Tabs to the button and presses it."""
        button = one.page.get_by_role("button", name=name)
        button.wait_for()
        for _ in range(30):
            if button.evaluate("(it) => it === document.activeElement"):
                keys.press("Enter")
                return
            keys.press("Tab")
        raise AssertionError(f"Tab does not reach {name}")

    press_focused("I agree to take part")
    press_focused("Begin")
    one.wait_for_heading("Practice first")
    press_focused("Continue")
    expected = []
    for i in range(5):
        while one.wait_for_screen() == "text":
            heading = one.page.get_by_role("heading").inner_text()
            press_focused("Continue")
            one.page.get_by_role("heading", name=re.escape(heading)).wait_for(state="detached")
        one.wait_for_questions()
        keys.press("6")  # realism, the first open question
        keys.press("3")  # speed; the focus moves on to the slider
        expect(one.page.get_by_role("slider")).to_be_focused()
        keys.press("ArrowRight")  # the thumb appears in the middle
        keys.press("PageUp")
        keys.press("ArrowLeft")
        keys.press("Tab")
        keys.type("typed 7")  # digits in the comment answer nothing
        form = one.page.locator(FORM).element_handle()
        press_focused("Continue")
        form.wait_for_element_state("hidden")
        expected.append({"realism": 6, "speed": 3, "fun": 59, "why": "typed 7"})
        assert len(expected) == i + 1
    one.page.locator(".code").wait_for()
    assert study_server.answers() == expected
    assert visit.complaints == []


def test_the_slider_has_no_thumb_until_it_is_touched(visit: Visit) -> None:
    one = visit.open()
    one.come_to_questions()
    slider = one.page.get_by_role("slider")
    thumb = one.page.locator(".thumb")
    expect(thumb).to_be_hidden()
    assert "no answer yet" in (slider.get_attribute("aria-valuetext") or "")
    box = slider.bounding_box()
    assert box is not None
    slider.click(position={"x": box["width"] / 2, "y": box["height"] / 2})
    expect(thumb).to_be_visible()  # a click on the middle is an answer, not a default
    expect(slider).to_have_attribute("aria-valuenow", "50")
    slider.press("End")
    expect(slider).to_have_attribute("aria-valuetext", "100, great fun")


def test_reduced_motion_is_respected(browser: Browser, study_server: StudyServer) -> None:
    context = browser.new_context(reduced_motion="reduce")
    one = Visit(context, study_server).open()
    button = one.page.get_by_role("button", name="I agree")
    assert button.evaluate("(it) => getComputedStyle(it).transitionDuration") == "0s"
    context.close()
