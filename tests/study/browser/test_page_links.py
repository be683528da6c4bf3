# SPDX-License-Identifier: MIT
"""Participant links at the page: one opens the study, every other kind is turned away calmly."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from axe import findings
from playwright.sync_api import Browser
from study_site import STUDY, StudyServer, Visit

from verisim.study.server.links import close_links, make_links
from verisim.study.server.researcher import at_work_on


@pytest.fixture
def linked(tmp_path: Path, clips: Path, page_build: Path) -> Iterator[tuple[StudyServer, str, str]]:
    """A server that takes nobody without a link, a link for one person, and a closed one."""
    del page_build
    server = StudyServer(tmp_path, clips, STUDY + "links: required\n")
    with at_work_on(server.study, clips, server.db) as connection:
        [one] = make_links(connection, 1, "person", "lab", 1)
        [old] = make_links(connection, 1, "old", "lab", 1)
        close_links(connection, "old")
    server.start()
    yield server, one.token, old.token
    server.kill()


def test_a_link_lets_one_person_in_and_refusals_say_why(
    browser: Browser, linked: tuple[StudyServer, str, str]
) -> None:
    server, token, closed = linked
    outcomes = [
        ("", "This study needs a personal link"),
        (f"?link={'guess' * 8}", "This link is not known"),
        (f"?link={closed}", "This link is closed"),
        (f"?link={token}", ""),
        (f"?link={token}", "This link was used before"),
    ]
    for query, refusal in outcomes:
        context = browser.new_context()
        one = Visit(context, server).open(query)
        one.press("I agree to take part")
        if refusal:
            one.wait_for_heading(refusal)
            assert one.page.locator("main button").all_inner_texts() == []  # nothing to try again
        else:
            one.page.get_by_role("button", name="Begin").wait_for()
            assert one.page.url == f"{server.address}/"  # the link is not left to be copied
            one.page.reload()  # and the visit goes on without it
            one.page.get_by_role("button", name="Begin").wait_for()
        assert findings(one.page) == []
        context.close()
    people = server.rows("SELECT source, invitation_id FROM participant")
    assert people == [{"source": "lab", "invitation_id": 1}]


def test_an_outside_name_of_odd_characters_is_never_sent(
    visit: Visit, study_server: StudyServer
) -> None:
    one = visit.open("?PROLIFIC_PID=Robert'); DROP TABLE&STUDY_ID=s1")
    one.press("I agree to take part")
    one.page.get_by_role("button", name="Begin").wait_for()
    assert study_server.rows("SELECT * FROM participant_link") == []
    [submission] = study_server.rows("SELECT count(*) num FROM submission WHERE body LIKE '%DROP%'")
    assert submission["num"] == 0
