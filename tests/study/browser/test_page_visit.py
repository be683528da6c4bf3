# SPDX-License-Identifier: MIT
"""A visit from its link to its end: languages, feedback, rests, stopping, completion, erasure."""

from __future__ import annotations

import re
from datetime import UTC, datetime

import pytest
from axe import findings
from mini_studies import IN_TWO_LANGUAGES
from page_participant import Participant
from playwright.sync_api import Browser, expect
from study_site import StudyServer, Visit

in_two_languages = pytest.mark.parametrize("study_server", [IN_TWO_LANGUAGES], indirect=True)


def states(server: StudyServer) -> list[str]:
    return [row["state"] for row in server.rows("SELECT state FROM participant")]


def answer_yes(one: Participant) -> None:
    one.wait_for_questions()
    one.page.locator("[name=answer-possible][value='1']").check()


def go_on_in_german(one: Participant, title: str) -> None:
    one.wait_for_heading(title)
    one.press("Weiter")
    one.page.get_by_role("heading", name=title).wait_for(state="detached")


@in_two_languages
def test_a_whole_visit_in_german_with_feedback_rests_and_last_questions(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    page = one.page
    page.get_by_role("link", name="Deutsch").click()
    expect(page.locator("html")).to_have_attribute("lang", "de")
    found = {"consent": findings(page)}
    one.press("Ich nehme teil")
    one.press("Beginnen")
    # What named the participant or their source is out of the address; a reload goes on in German.
    assert page.url == f"{study_server.address}/?lang=de"
    page.goto(study_server.address)
    go_on_in_german(one, "Zuerst zur Übung")
    one.wait_for_questions()
    expect(page.get_by_role("radiogroup", name="Ist das möglich?")).to_be_visible()
    answer_yes(one)
    one.press("Weiter")
    go_on_in_german(one, "Das stimmt")
    go_on_in_german(one, "Die Übung ist vorbei")
    for i in range(4):
        if i == 2:
            one.wait_for_heading("Zeit für eine kurze Pause")
            go_on = page.get_by_role("button", name="Weiter")
            expect(go_on).to_be_disabled()
            found["rest"] = findings(page)
            expect(go_on).to_be_enabled()
            go_on.click()
        answer_yes(one)
        one.submit("Weiter")
    one.wait_for_heading("Ein paar letzte Fragen")
    found["last questions"] = findings(page)
    page.get_by_role("radiogroup", name="Gab es Probleme?").get_by_role("radio").nth(1).check()
    page.get_by_role("textbox").fill("nach Gefühl")
    one.press("Weiter")
    page.locator(".end").wait_for()
    found["end"] = findings(page)
    expect(page.locator(".code")).to_have_text("DONE7")
    back = page.get_by_role("link", name="Zurückkehren und abschließen")
    expect(back).to_have_attribute("href", "https://example.org/back?cc=DONE7")
    assert states(study_server) == ["completed"]
    assert one.num_undelivered() == 0
    last = study_server.rows(
        "SELECT q.key, a.value, a.value_text, a.rt_ms FROM session_answer a "
        "JOIN question q USING (question_id) ORDER BY q.key"
    )
    assert [(row["key"], row["value"], row["value_text"]) for row in last] == [
        ("how", None, "nach Gefühl"),
        ("trouble", 0, None),
    ]
    assert all(0 < row["rt_ms"] < 60_000 for row in last)
    [consent] = study_server.rows("SELECT language FROM consent")
    assert consent["language"] == "de"
    assert found == {screen: [] for screen in found}
    assert visit.complaints == []


@in_two_languages
def test_wrong_practice_answers_are_told_so(visit: Visit, study_server: StudyServer) -> None:
    one = visit.open()
    one.come_to_questions()
    one.page.locator("[name=answer-possible][value='0']").check()
    one.submit()
    one.wait_for_heading("Not quite")
    one.press("Continue")
    one.wait_for_heading("Practice is over")
    assert study_server.rows("SELECT value FROM response") == [{"value": 0}]


@in_two_languages
def test_stopping_early_asks_once_more_keeps_the_answers_and_gives_the_partial_code(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.come_to_questions()
    answer_yes(one)
    one.submit()
    one.press("Continue")  # feedback
    one.press("Continue")  # practice is over
    one.wait_for_questions()
    one.press("Stop here")
    dialog = one.page.get_by_role("dialog", name="Stop taking part now?")
    assert findings(one.page) == []
    expect(dialog.get_by_role("button", name="Go on")).to_be_focused()
    one.page.keyboard.press("Escape")
    expect(dialog).to_have_count(0)
    answer_yes(one)  # the form is as it was
    one.press("Stop here")
    dialog.get_by_role("button", name="Stop here").click()
    one.wait_for_heading("You stopped early")
    expect(one.page.locator(".code")).to_have_text("PART3")
    assert states(study_server) == ["stopped"]
    # The trial that was left has a showing without an answer.
    shown = study_server.rows("SELECT completed FROM presentation ORDER BY received_utc")
    assert shown == [{"completed": 1}, {"completed": 0}]
    one.page.reload()
    one.wait_for_heading("You stopped early")


@in_two_languages
def test_a_withdrawal_link_deletes_everything_after_one_more_question(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.come_to_questions()
    answer_yes(one)
    one.submit()
    one.press("Continue")
    one.press("Continue")
    one.wait_for_questions()
    one.press("Stop here")
    one.page.get_by_role("dialog").get_by_role("button", name="Stop here").click()
    link = one.page.locator(".withdraw-link").inner_text()
    assert link.startswith(f"{study_server.address}/#withdraw=")

    one.page.goto("about:blank")  # a change after the # alone would not load the page
    one.page.goto(link)
    one.wait_for_heading("Delete all your answers?")
    assert findings(one.page) == []
    assert len(study_server.rows("SELECT * FROM participant")) == 1  # nobody is enrolled by this
    one.press("Delete my answers")
    one.wait_for_heading("Your answers are deleted")
    for table in ("participant", "session", "response", "presentation", "event", "submission"):
        assert study_server.rows(f"SELECT * FROM {table}") == []
    assert one.page.evaluate("Object.keys(localStorage)") == []
    one.page.reload()
    one.press("Delete my answers")
    one.wait_for_heading("There is nothing to delete")


@in_two_languages
def test_the_debrief_page_deletes_the_answers_on_request(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.come_to_questions()
    one.press("Stop here")
    one.page.get_by_role("dialog").get_by_role("button", name="Stop here").click()
    one.press("Delete my answers now")
    one.press("Keep my answers")
    assert states(study_server) == ["stopped"]
    one.press("Delete my answers now")
    one.page.get_by_role("dialog").get_by_role("button", name="Delete my answers").click()
    one.wait_for_heading("Your answers are deleted")
    assert states(study_server) == []


@in_two_languages
def test_recruitment_platforms_name_the_participant_once(
    browser: Browser, study_server: StudyServer
) -> None:
    query = "?PROLIFIC_PID=5f00aa11bb&STUDY_ID=s1&SESSION_ID=v1"
    for number in range(2):
        context = browser.new_context()
        one = Visit(context, study_server).open(query)
        one.press("I agree to take part")
        if number == 0:
            one.page.get_by_role("button", name="Begin").wait_for()
            assert one.page.url == f"{study_server.address}/"
        else:
            one.wait_for_heading("You have taken part already")
            assert findings(one.page) == []
        context.close()
    links = study_server.rows("SELECT platform, external_id, external_study FROM participant_link")
    assert links == [{"platform": "prolific", "external_id": "5f00aa11bb", "external_study": "s1"}]
    assert study_server.rows("SELECT source FROM participant") == [{"source": "prolific"}]


def test_a_preview_of_the_task_enrols_nobody(visit: Visit, study_server: StudyServer) -> None:
    one = visit.open("?assignmentId=ASSIGNMENT_ID_NOT_AVAILABLE&hitId=h1")
    one.wait_for_heading("This is a preview")
    assert one.page.get_by_role("button", name="I agree").count() == 0
    assert states(study_server) == []


def test_a_study_that_is_not_open_says_so_and_lets_running_visits_finish(
    browser: Browser, visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.come_to_questions()
    for state, title in (("paused", "The study is paused"), ("closed", "The study is closed")):
        study_server.change(f"UPDATE study SET state = '{state}'")
        context = browser.new_context()
        Visit(context, study_server).open().wait_for_heading(title)
        context.close()
    one.answer(0)
    one.submit()
    one.wait_for_heading("Practice is over")
    assert len(states(study_server)) == 1


# A computer whose clock jumps a day at every look, back and forth.
JUMPING_CLOCK = """
const now = Date.now.bind(Date);
let num_looks = 0;
Date.now = () => now() + (num_looks++ % 2 ? 86_400_000 : -86_400_000);
"""


def test_a_jumping_clock_and_a_far_time_zone_change_no_time(
    browser: Browser, study_server: StudyServer
) -> None:
    started = datetime.now(UTC)
    context = browser.new_context(timezone_id="Pacific/Kiritimati")
    context.add_init_script(JUMPING_CLOCK)
    one = Visit(context, study_server).open()
    one.come_to_questions()
    one.answer(1)
    one.submit()
    one.wait_for_heading("Practice is over")
    [session] = study_server.rows("SELECT tz_offset_min FROM session")
    assert session["tz_offset_min"] == 14 * 60
    ended = datetime.now(UTC)
    for row in study_server.rows("SELECT rt_ms, first_touch_ms, answered_utc FROM response"):
        assert 0 < row["first_touch_ms"] <= row["rt_ms"] < 60_000
        assert started <= datetime.fromisoformat(row["answered_utc"]) <= ended
    [shown] = study_server.rows("SELECT onset_ms, ended_ms FROM presentation")
    assert 240 < shown["ended_ms"] - shown["onset_ms"] < 10_000
    context.close()


def test_every_word_of_the_page_exists_in_german(page_build: None) -> None:
    """The type checker holds the languages together; here: no English text was left standing."""
    del page_build
    from study_site import WEB

    lines = [
        dict(re.findall(r'^  (\w+): "(.*)",$', (WEB / "src" / name).read_text(), re.MULTILINE))
        for name in ("texts.ts", "texts_de.ts")
    ]
    english, german = lines
    assert english.keys() == german.keys()
    assert [key for key in english if english[key] == german[key]] == []


@pytest.mark.parametrize("study_server", [(IN_TWO_LANGUAGES, {"kiosk": True})], indirect=True)
def test_in_a_kiosk_one_key_brings_the_next_participant(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open()
    one.come_to_questions()
    one.press("Stop here")
    one.page.get_by_role("dialog").get_by_role("button", name="Stop here").click()
    one.wait_for_heading("You stopped early")
    one.page.keyboard.press("n")
    one.page.get_by_role("button", name="I agree to take part").wait_for()
    assert one.page.url == f"{study_server.address}/"
    assert one.page.evaluate("Object.keys(localStorage)") == []
