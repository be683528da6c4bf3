# SPDX-License-Identifier: MIT
"""Checks of the screen: size, calibration, distance, codec, refresh rate, full screen, phones."""

from __future__ import annotations

import json
import math

import pytest
from axe import findings
from mini_studies import ROOM_ONLY, with_screen
from page_participant import FORM, Participant
from playwright.sync_api import Browser, expect
from study_site import StudyServer, Visit

CARD_MM = 85.6
# A screen of 50 Hz, as far as a page can tell.
AT_50_HZ = """
let frame = 0;
window.requestAnimationFrame = (tick) => setTimeout(() => tick(++frame * 1000 / 50), 1);
"""
# A browser that claims to play the format and then shows nothing.
BROKEN_DECODER = """
Object.defineProperty(HTMLMediaElement.prototype, 'src', {set() {
    this.setAttribute('src', URL.createObjectURL(new Blob(['no video'])));
}});
"""


def calibrate(one: Participant, distance_cm: str = "60", before_check: str = "0") -> None:
    """Tells the size of the screen by the keyboard; before_check: run before the page looks."""
    edge = one.page.get_by_role("slider", name="Width of the drawn card")
    expect(one.page.get_by_role("button", name="It has the same size")).to_be_disabled()
    for key in ["PageUp"] * 6 + ["Shift+ArrowRight"]:
        edge.press(key)
    assert edge.get_attribute("aria-valuenow") == "324"  # a card at 96 CSS px per inch
    one.press("It has the same size")
    distance = one.page.get_by_label("Distance in centimetres")
    distance.fill(distance_cm)
    one.page.evaluate(f"() => {{ {before_check} }}")
    distance.press("Enter")


@pytest.mark.parametrize("study_server", [with_screen(fullscreen="require")], indirect=True)
def test_a_screen_is_measured_and_full_screen_is_kept(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    page = one.page
    one.press("I agree to take part")
    one.wait_for_heading("Full screen")
    found = {"full screen": findings(page)}
    one.press("Go to full screen")
    one.wait_for_heading("How large is your screen?")
    found["card"] = findings(page)
    edge = page.get_by_role("slider", name="Width of the drawn card")
    start_px = int(edge.get_attribute("aria-valuenow") or "0")
    drawn = page.locator(".bank-card").bounding_box()
    assert drawn is not None
    assert drawn["width"] / drawn["height"] == pytest.approx(CARD_MM / 53.98, rel=0.01)
    edge.press("ArrowRight")
    one.press("It has the same size")
    one.wait_for_heading("How far are you from the screen?")
    distance = page.get_by_label("Distance in centimetres")
    distance.fill("5")
    one.press("Continue")
    found["wrong distance"] = findings(page)
    expect(page.get_by_text("Please enter a number from 30 to 150.")).to_be_visible()
    distance.fill("60")
    distance.press("Enter")
    page.get_by_role("button", name="Begin").wait_for()

    px_per_mm = (start_px + 1) / CARD_MM
    [check] = study_server.rows("SELECT * FROM screen_check")
    assert check["verdict"] in ("passed", "flagged")  # a busy machine may miss the refresh rate
    assert (check["codec_plays"], check["fullscreen"], check["calibration_skipped"]) == (1, 1, 0)
    assert check["css_px_per_mm"] == pytest.approx(px_per_mm)
    assert check["viewing_distance_mm"] == 600
    degree_mm = 2 * 600 * math.tan(math.radians(0.5))
    assert check["px_per_degree"] == pytest.approx(px_per_mm * degree_mm)
    assert 20 < check["refresh_hz"] < 200  # measured 59.9 on a screen without a display

    one.press("Begin")
    one.press("Continue")
    one.wait_for_questions()
    page.evaluate("document.exitFullscreen()")
    one.answer_anything()
    one.submit()
    one.press("Continue")
    one.wait_for_heading("Back to full screen")
    one.press("Go to full screen")
    one.wait_for_questions()
    one.answer_anything()
    one.submit()
    one.page.locator(f".stage, {FORM}").first.wait_for()  # what comes once the answer is stored
    shown = study_server.rows("SELECT fullscreen, scale FROM presentation")
    assert shown == [{"fullscreen": 1, "scale": 4}] * 2
    assert found == {screen: [] for screen in found}


@pytest.mark.parametrize("study_server", [with_screen()], indirect=True)
def test_what_can_be_put_right_is_explained_and_checked_again(
    browser: Browser, study_server: StudyServer
) -> None:
    context = browser.new_context(viewport={"width": 900, "height": 500})
    one = Visit(context, study_server).open()
    one.press("I agree to take part")
    one.wait_for_heading("The window is too small")
    expect(one.page.locator("main")).to_contain_text("1000 × 600 pixels; this one has 900 × 500")
    one.press("Check again")
    one.wait_for_heading("The window is too small")
    one.page.set_viewport_size({"width": 1280, "height": 720})
    one.press("Check again")
    calibrate(one, "150")  # so far away that a degree holds 99 pixels
    one.wait_for_heading("This screen does not fit yet")
    expect(one.page.locator("main")).to_contain_text("sit nearer or further away")
    one.press("Try again")
    calibrate(one, "60")
    one.page.get_by_role("button", name="Begin").wait_for()
    verdicts = [row["verdict"] for row in study_server.rows("SELECT verdict FROM screen_check")]
    assert len(verdicts) == 2
    assert verdicts[0] == "refused"
    assert verdicts[1] in ("passed", "flagged")
    context.close()


@pytest.mark.parametrize("study_server", [with_screen(rules=ROOM_ONLY)], indirect=True)
def test_page_and_server_agree_on_the_room_that_clips_need(
    browser: Browser, study_server: StudyServer
) -> None:
    # 320 x 180 device pixels are 213.3 x 120 CSS pixels here, which only 214 columns hold.
    context = browser.new_context(viewport={"width": 213, "height": 600}, device_scale_factor=1.5)
    one = Visit(context, study_server).open()
    one.press("I agree to take part")
    one.wait_for_heading("The window is too small")
    expect(one.page.locator("main")).to_contain_text("214 × 120 pixels; this one has 213 × 600")
    one.page.set_viewport_size({"width": 214, "height": 600})
    one.press("Check again")
    one.page.get_by_role("button", name="Begin").wait_for()
    context.close()
    checks = study_server.rows("SELECT verdict, viewport_w_px FROM screen_check")
    assert checks == [{"verdict": "passed", "viewport_w_px": 214}]


@pytest.mark.parametrize("study_server", [with_screen("refuse")], indirect=True)
def test_a_device_that_cannot_show_the_study_is_turned_away_with_the_reason(
    browser: Browser, study_server: StudyServer
) -> None:
    phone = "Mozilla/5.0 (Linux; Android 14; Pixel 8) AppleWebKit/537.36 Chrome/156.0 Mobile"
    reasons = {
        "refresh": "The refresh rate of this screen",
        "codec": "This browser does not play the clips.",
        "phone": "it does not run on a phone",
    }
    for trouble, words in reasons.items():
        context = browser.new_context(
            viewport={"width": 1280, "height": 720},
            user_agent=phone if trouble == "phone" else None,
        )
        one = Visit(context, study_server).open()
        one.press("I agree to take part")
        calibrate(one, before_check={"refresh": AT_50_HZ, "codec": BROKEN_DECODER}.get(trouble, ""))
        one.wait_for_heading("This device cannot show the study")
        expect(one.page.locator("main")).to_contain_text(words)
        expect(one.page.locator(".code")).to_have_text("OUT1")
        link = one.page.get_by_role("link", name="Return and finish")
        expect(link).to_have_attribute("href", "https://example.org/out?cc=OUT1")
        assert findings(one.page) == []
        *_, check = study_server.rows("SELECT * FROM screen_check ORDER BY checked_utc")
        assert check["verdict"] == "refused"
        assert trouble in [it["code"] for it in json.loads(check["problems_json"])]
        context.close()
    participants = study_server.rows("SELECT state FROM participant")
    assert participants == [{"state": "screened_out"}] * 3
