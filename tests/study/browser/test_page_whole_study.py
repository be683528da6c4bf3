# SPDX-License-Identifier: MIT
"""From consent to completion: the database holds exactly what was answered."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from mini_clips import NUM_FRAMES
from playwright.sync_api import Browser
from study_site import StudyServer, Visit


def test_a_whole_study_with_a_reload_stores_exactly_the_answers_given(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.come_to_questions()
    one.answer(0)
    one.submit()
    one.wait_for_heading("Practice is over")
    one.press("Continue")
    one.wait_for_questions()
    one.answer(1)
    one.submit()

    one.wait_for_clip()
    one.page.reload()
    one.wait_for_heading("Welcome back")
    code = one.finish(first=2)

    assert len(one.given) == 5
    assert study_server.answers() == one.given
    assert one.num_undelivered() == 0
    [participant] = study_server.rows("SELECT * FROM participant")
    assert (participant["state"], participant["source"]) == ("completed", "simulated")
    assert participant["completion_code"] == code
    [consent] = study_server.rows("SELECT agreed, form_version FROM consent")
    assert consent == {"agreed": 1, "form_version": "1"}
    assert visit.complaints == []

    # The showing that the reload broke off is a row of its own, and so is its second showing.
    showings = study_server.rows(
        "SELECT p.*, t.trial_index FROM presentation p JOIN trial t USING (trial_id) "
        "ORDER BY t.trial_index, p.completed"
    )
    assert [(s["trial_index"], s["completed"]) for s in showings] == [
        (0, 1), (1, 1), (2, 0), (2, 1), (3, 1), (4, 1),
    ]  # fmt: skip
    for shown in showings:
        if not shown["completed"]:
            continue
        assert shown["num_plays"] == 1
        # 18 of 18 measured; the browser may count fewer when it cannot keep up.
        assert 0.5 * NUM_FRAMES <= shown["frames_total"] <= NUM_FRAMES + 4
        assert 0 <= shown["frames_dropped"] <= shown["frames_total"]
        # 300 ms of clip: measured 275 to 310 ms from the first frame to the end.
        assert 240 < shown["ended_ms"] - shown["onset_ms"] < 10_000
        assert shown["first_frame_ms"] >= 0
        assert (shown["displayed_w_px"], shown["displayed_h_px"]) == (1280, 720)  # 4 x 320, 4 x 180
    responses = study_server.rows(
        "SELECT rt_ms, first_touch_ms, num_changes, rt_origin FROM response"
    )
    assert all(0 < r["first_touch_ms"] <= r["rt_ms"] < 60_000 for r in responses)
    assert {r["rt_origin"] for r in responses} == {"video_end"}
    assert {r["num_changes"] for r in responses} == {0}
    events = study_server.rows("SELECT seq, kind FROM event ORDER BY seq")
    assert [e["kind"] for e in events].count("play_ended") == 5
    assert len({e["seq"] for e in events}) == len(events)


def test_watching_again_is_counted_and_keeps_the_answers(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.come_to_questions()
    one.answer(0)
    one.press("Watch again")
    one.page.locator(".stage").wait_for()
    one.wait_for_questions()
    assert one.page.get_by_role("button", name="Watch again").count() == 0
    one.page.locator("[name=answer-realism][value='7']").check()
    one.given[0]["realism"] = 7
    one.submit()
    one.wait_for_heading("Practice is over")
    assert study_server.answers() == one.given
    [shown] = study_server.rows("SELECT num_plays, frames_total FROM presentation")
    assert shown["num_plays"] == 2
    assert shown["frames_total"] > NUM_FRAMES + 4  # both plays: 36 measured
    [changed] = study_server.rows(
        "SELECT num_changes FROM response JOIN question USING (question_id) WHERE key = 'realism'"
    )
    assert changed == {"num_changes": 1}
    assert visit.complaints == []


def test_declining_is_recorded_and_sends_nothing_before(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.page.get_by_role("button", name="I do not take part").wait_for()
    assert study_server.rows("SELECT * FROM participant") == []
    one.press("I do not take part")
    one.wait_for_heading("You decided not to take part")
    assert study_server.rows("SELECT agreed FROM consent") == [{"agreed": 0}]
    one.press("I changed my mind")
    one.come_to_questions()
    states = [row["state"] for row in study_server.rows("SELECT state FROM participant")]
    assert sorted(states) == ["active", "declined"]


def test_clips_are_shown_at_whole_multiples_of_their_pixels(
    browser: Browser, study_server: StudyServer
) -> None:
    windows = [
        (1280, 720, 1, (1280, 720)),  # 4 times
        (1279, 720, 1, (960, 540)),  # 3 times: the next whole multiple
        (390, 844, 3, (960, 540)),  # 3 times, in device pixels
        (300, 600, 1, (300, 169)),  # too small for the clip: scaled down
    ]
    for width, height, ratio, shown in windows:
        context = browser.new_context(
            viewport={"width": width, "height": height}, device_scale_factor=ratio
        )
        one = Visit(context, study_server).open()
        one.come_to_first_clip()
        one.wait_for_clip()
        box = one.page.locator("video").bounding_box()
        assert box is not None
        assert (box["width"] * ratio, box["height"] * ratio) == pytest.approx(shown, abs=0.1)
        one.wait_for_questions()
        one.answer(0)
        one.submit()
        one.wait_for_heading("Practice is over")
        context.close()
    rows = study_server.rows(
        "SELECT displayed_w_px w, displayed_h_px h, scale FROM presentation ORDER BY received_utc"
    )
    assert [(row["w"], row["h"]) for row in rows] == [shown for *_, shown in windows]
    assert [row["scale"] for row in rows] == [4, 3, 3, None]


def test_the_page_passes_the_type_checker(page_build: Path) -> None:
    checked = subprocess.run(
        ["npm", "run", "-s", "check"], cwd=page_build, capture_output=True, text=True, check=False
    )
    assert checked.returncode == 0, checked.stdout
