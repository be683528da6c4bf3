# SPDX-License-Identifier: MIT
"""Clips that do not come, come wrong or will not play: a clear screen, a way on, never a hang."""

from __future__ import annotations

import json

from playwright.sync_api import Route
from study_site import StudyServer, Visit

TROUBLES = {
    "500": "did not deliver the clip",
    "403": "did not deliver the clip",
    "short": "arrived damaged",
    "other bytes": "arrived damaged",
    "no answer": "did not arrive completely",
}


def test_each_broken_clip_shows_the_error_screen_until_trying_again_works(
    visit: Visit, study_server: StudyServer
) -> None:
    trouble = ""

    def spoil(route: Route) -> None:
        if trouble == "no answer":
            route.abort()
        elif trouble.isdigit():
            route.fulfill(status=int(trouble))
        else:
            body = route.fetch().body()
            route.fulfill(body=body[:-1] if trouble == "short" else body[:-1] + b"\0")

    one = visit.open()
    one.page.route("**/media/*", spoil)
    for trouble, words in TROUBLES.items():
        if trouble == "500":
            one.come_to_first_clip()
        else:
            one.press("Try again")
        one.page.get_by_text(words).wait_for()
        one.wait_for_heading("The clip could not be shown")
    one.page.unroute("**/media/*")
    one.press("Try again")
    one.wait_for_questions()
    one.answer(0)
    one.submit()
    one.wait_for_heading("Practice is over")
    assert study_server.answers() == one.given
    events = study_server.rows(
        "SELECT detail_json FROM event WHERE kind = 'clip_problem' ORDER BY seq"
    )
    failures = [json.loads(event["detail_json"])["failure"] for event in events]
    assert failures == ["status", "status", "wrong_bytes", "wrong_bytes", "no_bytes"]
    assert [c for c in visit.complaints if "Failed to load resource" not in c] == []


def test_a_clip_whose_bytes_stay_away_ends_at_the_error_screen(visit: Visit) -> None:
    one = visit.open()
    one.page.get_by_role("button", name="I agree to take part").wait_for()
    unanswered: list[Route] = []
    one.page.route("**/media/*", lambda route: unanswered.append(route))
    one.page.clock.install()
    one.come_to_first_clip()
    one.page.get_by_role("progressbar", name="Loading the clip").wait_for()
    one.page.clock.fast_forward(19_000)
    assert one.page.get_by_role("heading", name="The clip could not be shown").count() == 0
    one.page.clock.fast_forward(2_000)
    one.wait_for_heading("The clip could not be shown")
    assert len(unanswered) == 1
    unanswered[0].abort()


def test_bytes_that_are_no_video_show_the_error_screen(visit: Visit) -> None:
    """The bytes pass every check, yet the decoder refuses them."""
    one = visit.open()
    spoil = "Object.defineProperty(HTMLMediaElement.prototype, 'src', {set() {" + (
        "this.setAttribute('src', URL.createObjectURL(new Blob(['no video']))); }});"
    )
    one.page.evaluate(spoil)
    one.come_to_first_clip()
    one.wait_for_heading("The clip could not be shown")
    assert "cannot play the clip" in one.page.locator("main").inner_text()


def test_a_browser_that_blocks_playing_asks_for_a_press(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.page.evaluate(
        """() => {
            const play = HTMLMediaElement.prototype.play;
            HTMLMediaElement.prototype.play = function () {
                HTMLMediaElement.prototype.play = play;
                return Promise.reject(new DOMException('blocked', 'NotAllowedError'));
            };
        }"""
    )
    one.come_to_first_clip()
    one.press("Press to start the clip")
    one.wait_for_questions()
    one.answer(0)
    one.submit()
    one.wait_for_heading("Practice is over")
    [shown] = study_server.rows("SELECT num_plays, onset_ms, first_frame_ms FROM presentation")
    assert shown["num_plays"] == 1
    [blocked] = study_server.rows("SELECT t_ms FROM event WHERE kind = 'play_blocked'")
    # The first frame's delay counts from the press, not from the call that was blocked.
    assert shown["onset_ms"] - shown["first_frame_ms"] > blocked["t_ms"]


def test_a_clip_that_something_pauses_goes_on_by_itself(visit: Visit) -> None:
    one = visit.open()
    one.come_to_first_clip()
    one.wait_for_clip()
    one.page.evaluate("document.querySelector('video').pause()")
    one.wait_for_questions()


def test_a_slow_line_is_waited_for_and_the_clip_then_plays_without_a_stall(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.page.get_by_role("button", name="I agree to take part").wait_for()
    network = one.page.context.new_cdp_session(one.page)
    network.send(
        "Network.emulateNetworkConditions",
        # A clip of some 40 KB takes about a second.
        {"offline": False, "latency": 200, "downloadThroughput": 40_000, "uploadThroughput": -1},
    )
    one.come_to_first_clip()
    loading = one.page.get_by_role("progressbar", name="Loading the clip")
    loading.wait_for()
    one.wait_for_questions()
    network.detach()
    one.answer(0)
    one.submit()
    one.wait_for_heading("Practice is over")
    [shown] = study_server.rows("SELECT stall_count, stall_ms FROM presentation")
    assert shown == {"stall_count": 0, "stall_ms": 0}  # it plays from memory
