# SPDX-License-Identifier: MIT
"""Every kind of question: nothing chosen beforehand, the keyboard is enough, answers are stored."""

from __future__ import annotations

from typing import Any

import pytest
from axe import findings
from mini_studies import ALL_KINDS
from page_participant import Participant
from playwright.sync_api import expect
from study_site import StudyServer, Visit

all_kinds = pytest.mark.parametrize("study_server", [ALL_KINDS], indirect=True)

ANSWERS = (
    "SELECT q.key || CASE r.item WHEN '' THEN '' ELSE '.' || r.item END AS key, r.* "
    "FROM response r JOIN question q USING (question_id)"
)


def stored(server: StudyServer) -> dict[str, Any]:
    return {row["key"]: row for row in server.rows(ANSWERS)}


def options(one: Participant, prompt: str) -> list[str]:
    return one.page.get_by_role("radiogroup", name=prompt).locator("label").all_inner_texts()


@all_kinds
def test_the_keyboard_answers_every_kind_and_nothing_is_chosen_beforehand(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.come_to_questions()
    page, keys = one.page, one.page.keyboard
    assert page.locator("input:checked").count() == 0
    expect(page.locator(".thumb")).to_be_hidden()
    order = options(one, "What moved?")
    found = {"empty": findings(page)}
    one.press("Continue")
    # Everything but the comment, which is not asked yet, and the mark, which is optional.
    expect(page.locator(".missing:visible")).to_have_count(10)
    found["missing"] = findings(page)

    page.get_by_role("heading").first.focus()
    for digit in "624":  # realism, smooth (has three points only: see below), speed
        keys.press(digit)
    keys.press("1")
    expect(page.get_by_role("slider")).to_be_focused()
    keys.press("End")
    keys.press("Tab")
    keys.press("2")  # possible: the second button
    keys.press("1")  # moved: the first
    keys.press("1")  # laws: kept
    keys.press("3")  # laws: cannot tell
    keys.press("4")  # fun
    keys.press("5")  # calm
    keys.press("1")  # uneasy
    keys.press("2")  # sure
    expect(page.get_by_role("button", name="Continue")).to_be_focused()

    page.get_by_role("button", name="Play and pause").press("Enter")
    page.locator(".stage-panel").wait_for()
    page.get_by_role("button", name="Mark this moment").wait_for()  # paused, or over
    found["mark"] = findings(page)
    keys.press("ArrowLeft")
    keys.press("Enter")
    page.get_by_text("at 0.").wait_for()
    found["answered"] = findings(page)
    is_possible = options(one, "Could it happen?")[1] == "Yes"
    if not is_possible:
        page.get_by_role("textbox").fill("it hopped")
    page.get_by_role("button", name="Continue").press("Enter")
    one.wait_for_heading("Practice is over")

    rows = stored(study_server)
    given = {key: row["value_text"] or row["value"] for key, row in rows.items()}
    mark_ms = given.pop("when.m1")
    assert 200 <= mark_ms <= 300  # of 300 ms; one frame before the end or the pause
    words = {"a thing": "thing", "an animal": "animal", "something else": "other"}
    assert given == {
        "realism": 6,
        "smooth": 2,
        "speed": 4,
        "natural": 100,
        "possible": int(is_possible),
        "moved": words[order[0]],
        "laws.gravity": "kept",
        "laws.solid": "cannot_tell",
        "fun": 4,
        "feel.calm": 5,
        "feel.uneasy": 1,
        "sure": 2,
    }
    comments = study_server.rows("SELECT body FROM comment")
    assert comments == ([] if is_possible else [{"body": "it hopped"}])
    [shown] = study_server.rows("SELECT num_plays, num_mark_plays, frames_total FROM presentation")
    assert (shown["num_plays"], shown["num_mark_plays"]) == (1, 1)
    assert found == {state: [] for state in found}
    assert visit.complaints == []


@all_kinds
def test_times_changes_and_the_order_of_buttons_are_recorded(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.come_to_questions()
    one.answer_anything()
    one.page.locator("[name=answer-realism][value='5']").check()
    one.page.locator("[name=answer-realism][value='6']").check()
    one.page.get_by_role("button", name="I saw nothing wrong").click()
    shown_order = options(one, "Could it happen?")
    one.submit()
    one.wait_for_heading("Practice is over")
    rows = stored(study_server)
    assert rows["realism"]["num_changes"] == 2
    assert rows["smooth"]["num_changes"] == 0
    assert rows["when"]["value_text"] == "none"
    [shown] = study_server.rows("SELECT onset_ms, ended_ms, scale FROM presentation")
    assert shown["scale"] == 4
    watched_ms = shown["ended_ms"] - shown["onset_ms"]
    for row in rows.values():
        assert 0 < row["first_touch_ms"] <= row["rt_ms"]
        assert row["rt_onset_ms"] - row["rt_ms"] == pytest.approx(watched_ms, abs=0.01)
    [participant] = study_server.rows("SELECT buttons FROM participant")
    is_reversed = participant["buttons"] == "reversed"
    assert shown_order == (["No", "Yes"] if is_reversed else ["Yes", "No"])
    assert {key: row["reversed"] for key, row in rows.items()} == {
        key: int(is_reversed and key in ("possible", "moved")) for key in rows
    }


@all_kinds
def test_a_question_that_depends_on_an_answer_comes_goes_and_is_sent_only_while_it_is_asked(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.come_to_questions()
    why = one.page.get_by_role("textbox", name="Why?")
    expect(why).to_be_hidden()
    one.page.locator("[name=answer-possible][value='0']").check()
    expect(why).to_be_visible()
    one.answer_anything()
    one.page.locator("[name=answer-possible][value='0']").check()
    why.fill("because")
    one.page.locator("[name=answer-possible][value='1']").check()
    expect(why).to_be_hidden()
    one.submit()
    one.wait_for_heading("Practice is over")
    assert study_server.rows("SELECT * FROM comment") == []
    assert stored(study_server)["possible"]["value"] == 1


@all_kinds
def test_a_mark_can_be_set_moved_by_frames_and_taken_back(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.come_to_questions()
    one.answer_anything()
    for _ in range(2):
        one.page.get_by_role("button", name="Play and pause").or_(
            one.page.get_by_role("button", name="Mark another moment")
        ).click()
        one.page.get_by_role("button", name="Mark this moment").wait_for()
        for _ in range(6):
            one.page.get_by_role("button", name="Earlier").click()
        one.page.get_by_role("button", name="Mark this moment").click()
        one.page.locator(".stage").wait_for(state="detached")
    entries = one.page.locator(".marks li")
    expect(entries).to_have_count(2)
    expect(one.page.get_by_role("button", name="Mark another moment")).to_be_disabled()
    entries.first.get_by_role("button").click()
    expect(entries).to_have_count(1)
    one.page.get_by_role("button", name="Mark another moment").click()
    one.page.keyboard.press("Escape")  # at once: it may come before the play begins, or after
    one.page.locator(".stage").wait_for(state="detached")
    one.submit()
    one.wait_for_heading("Practice is over")
    marks = [row for row in stored(study_server).values() if row["key"].startswith("when")]
    [mark] = marks
    # 18 frames of 16.7 ms; six frames back from the end or the pause before it.
    assert 0 <= mark["value"] <= 217
    [shown] = study_server.rows("SELECT num_plays, num_mark_plays FROM presentation")
    assert shown["num_plays"] == 1
    assert shown["num_mark_plays"] in (2, 3)


@all_kinds
def test_no_answer_lights_up_because_the_pointer_happens_to_lie_on_it(
    visit: Visit, study_server: StudyServer
) -> None:
    del study_server
    one = visit.open()
    page = one.page
    one.come_to_questions()
    face = page.locator(".point-face").first
    box = face.bounding_box()  # the next form lies where this one does
    assert box is not None
    one.answer_anything()
    page.get_by_role("button", name="Continue").press("Enter")
    one.wait_for_heading("Practice is over")
    page.get_by_role("button", name="Continue").press("Enter")
    page.locator(".stage").wait_for()
    page.mouse.move(box["x"] + 10, box["y"] + 10)  # while the clip plays
    one.wait_for_questions()
    is_plain = "(it) => getComputedStyle(it).backgroundColor === 'rgba(0, 0, 0, 0)'"
    page.wait_for_timeout(200)  # colours fade in within 120 ms
    assert face.evaluate("(it) => it.parentElement.matches(':hover')")
    assert face.evaluate(is_plain)
    page.mouse.move(box["x"] + 14, box["y"] + 14)
    page.wait_for_timeout(200)
    assert not face.evaluate(is_plain)
