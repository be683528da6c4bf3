# SPDX-License-Identifier: MIT
"""Dead servers, closed tabs, double clicks and refusals: each answer arrives exactly once."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from mini_studies import IN_TWO_LANGUAGES
from page_participant import TEXT_SCREEN
from playwright.sync_api import Route, expect
from study_site import StudyServer, Visit

NO_ANSWER = "net::ERR_CONNECTION_REFUSED"


def num_trial_submissions(server: StudyServer) -> int:
    return len(server.rows("SELECT * FROM submission WHERE kind = 'trials'"))


def test_an_answer_given_while_the_server_is_dead_arrives_once_by_itself(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.come_to_first_clip()
    one.wait_for_clip()
    study_server.kill()
    one.wait_for_questions()
    one.answer(0)
    one.submit()
    one.wait_for_heading("Connection lost")
    assert one.num_undelivered() > 0
    assert study_server.answers() == []
    study_server.start()
    one.wait_for_heading("Practice is over")
    assert one.num_undelivered() == 0
    assert study_server.answers() == one.given
    assert num_trial_submissions(study_server) == 1
    assert [c for c in visit.complaints if NO_ANSWER not in c] == []


def test_an_answer_survives_the_closing_of_its_tab(visit: Visit, study_server: StudyServer) -> None:
    one = visit.open()
    one.come_to_questions()
    study_server.kill()
    one.answer(0)
    one.submit()
    one.wait_for_heading("Connection lost")
    one.page.close()
    study_server.start()
    other = visit.open()
    other.wait_for_heading("Welcome back")
    assert other.num_undelivered() == 0
    assert study_server.answers() == one.given
    assert num_trial_submissions(study_server) == 1


def test_an_answer_whose_acknowledgement_is_lost_is_stored_once(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.come_to_questions()
    num_lost = 0

    def lose_first(route: Route) -> None:
        nonlocal num_lost
        num_lost += 1
        if num_lost == 1:
            route.fetch()  # the server stores it
            route.abort()  # and the page never hears of it
        else:
            route.continue_()

    one.page.route("**/api/trials", lose_first)
    one.answer(0)
    one.submit()
    one.wait_for_heading("Practice is over")
    assert num_lost == 2
    assert study_server.answers() == one.given
    assert num_trial_submissions(study_server) == 1


def test_a_double_click_submits_once_and_skips_nothing(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    agree = one.page.get_by_role("button", name="I agree to take part")
    agree.scroll_into_view_if_needed()
    box = agree.bounding_box()
    assert box is not None
    one.page.mouse.move(box["x"] + 20, box["y"] + 20)
    one.page.mouse.down()
    one.page.mouse.up()
    # The second click arrives late and meets the next screen's button at the same place.
    begin = one.page.get_by_role("button", name="Begin")
    box = begin.bounding_box()
    assert box is not None
    one.page.mouse.move(box["x"] + 20, box["y"] + 20)
    one.page.mouse.down(click_count=2)
    one.page.mouse.up(click_count=2)
    one.page.wait_for_timeout(200)
    assert begin.is_enabled()
    one.page.get_by_role("button", name="Begin").dblclick()
    one.page.get_by_role("button", name="Continue").dblclick()
    one.wait_for_questions()
    one.answer(0)
    one.page.get_by_role("button", name="Continue").dblclick()
    one.wait_for_heading("Practice is over")
    assert study_server.answers() == one.given
    kinds = [row["kind"] for row in study_server.rows("SELECT kind FROM submission")]
    assert sorted(kinds) == ["consent", "events", "instructions", "session", "trials"]
    assert visit.complaints == []


def test_a_missing_answer_is_pointed_at_and_nothing_is_sent(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.come_to_questions()
    one.page.locator("[name=answer-realism][value='3']").check()
    one.press("Continue")
    expect(one.page.locator(".missing:visible")).to_have_count(2)  # speed and fun; why is optional
    expect(one.page.locator("[name=answer-speed]").first).to_be_focused()
    assert num_trial_submissions(study_server) == 0


def test_a_refused_answer_can_be_rescued_as_a_file(
    visit: Visit, study_server: StudyServer, tmp_path: Path
) -> None:
    one = visit.open()
    one.come_to_questions()
    refusal = {"error": {"code": "invalid", "message": "made up", "hint": ""}}
    one.page.route("**/api/trials", lambda route: route.fulfill(status=422, json=refusal))
    one.answer(1)
    one.submit()
    one.wait_for_heading("Please tell the experimenter")
    with one.page.expect_download() as downloading:
        one.press("Download my answers")
    file = tmp_path / "answers.json"
    downloading.value.save_as(file)
    [letter] = [it for it in json.loads(file.read_text()) if it["path"] == "/api/trials"]
    answers = {
        it["question"]: it["value"] or it["value_text"] for it in letter["body"]["responses"]
    }
    assert answers == one.given[0]
    assert "token" not in letter
    one.page.unroute("**/api/trials")
    one.press("Try again")
    one.wait_for_heading("Practice is over")
    assert study_server.answers() == one.given


def test_a_visit_that_the_server_does_not_know_says_so(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.come_to_questions()
    study_server.kill()
    study_server.db.unlink()
    study_server.start()
    one.page.reload()
    one.wait_for_heading("This visit is no longer known")
    one.press("Start from the beginning")
    one.come_to_questions()


@pytest.mark.parametrize("study_server", [IN_TWO_LANGUAGES], indirect=True)
def test_the_last_page_waits_until_the_last_answer_is_delivered(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.come_to_questions()
    for _ in range(5):
        one.wait_for_questions()
        one.answer_anything()
        one.submit()
        while one.wait_for_screen() == "text":
            title = one.page.get_by_role("heading").first.inner_text()
            one.page.locator(TEXT_SCREEN).first.click()
            one.page.get_by_role("heading", name=title).wait_for(state="detached")
    one.wait_for_heading("A few last questions")
    study_server.kill()
    one.answer_anything()
    one.submit()
    one.wait_for_heading("Connection lost")
    with one.page.expect_download() as downloading:
        one.press("Download my answers")
    kept = json.loads(downloading.value.path().read_text())
    assert [letter["path"] for letter in kept] == ["/api/end_questions"]
    assert one.page.locator(".code").count() == 0
    study_server.start()
    one.page.locator(".code").wait_for()
    assert one.num_undelivered() == 0
    assert len(study_server.rows("SELECT * FROM session_answer")) == 2
