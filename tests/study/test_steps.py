# SPDX-License-Identifier: MIT
"""The whole session: screen check, feedback, conditions, last questions, stopping, withdrawal."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from study_tools import (
    ENVIRONMENT,
    FULL,
    PAIRS,
    STUDY,
    Person,
    Server,
    error_code,
    new_id,
    presentation,
    response,
    write_study,
)

from verisim.study.server.database import writing_engine
from verisim.study.server.redaction import redact_remark
from verisim.study.server.screen_check import needed_viewport
from verisim.study.server.stimulus_set import load_stimulus_set
from verisim.study.server.study_parts import ScreenRules

SCREEN = {
    "environment": {**ENVIRONMENT, "viewport_w": 1280, "viewport_h": 720},
    "codec_plays": True,
    "fullscreen": False,
    "refresh_hz": 59.9,
    "css_px_per_mm": 3.8,
    "viewing_distance_mm": 600,
}


@pytest.fixture(scope="module")
def full(set_dir: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    study = write_study(tmp_path_factory.mktemp("full"), FULL)
    with Server(study, set_dir, tmp_path_factory.mktemp("db") / "full.db") as server:
        yield server


def screen(**changes: Any) -> dict[str, Any]:
    return {"submission_id": new_id(), **SCREEN, **changes}


def answers(realism: float = 5, plausible: float = 1, **more: Any) -> list[dict[str, Any]]:
    given = [
        response("realism", realism),
        response("speed", 3),
        response("plausible", plausible),
        response("fun", 50),
    ]
    return given + more.get("more", [])


def trial(person: Person, responses: list[dict[str, Any]], **shown: Any) -> Any:
    return person.post(
        "trials",
        submission_id=new_id(),
        trial_id=person.trial()["trial_id"],
        presentation=presentation(**shown),
        responses=responses,
    )


def at_trials(server: Server, **changes: Any) -> Person:
    person = Person.arrive(server, **changes)
    assert person.agree().status_code == 201
    assert person.post("screen", **screen()).json()["verdict"] == "passed"
    assert person.post("instructions", submission_id=new_id()).status_code == 201
    return person


def finish(person: Person) -> dict[str, Any]:
    while (step := person.next())["step"] == "trial":
        assert trial(person, answers()).status_code == 201
    return step


def test_the_page_is_told_everything_it_needs(full: Server) -> None:
    with full.client() as client:
        study = client.get("/api/study").json()
    assert study["state"] == "open" and study["mode"] == "open" and study["kiosk"] is False
    assert study["can_stop"] and study["practice_feedback"] and study["minutes"] > 0
    assert [q["kind"] for q in study["end_questions"]] == ["category", "comment"]
    assert study["screen"]["frame_rates_hz"] == [30] and study["screen"]["clip_px"] == [64, 48]
    assert study["screen"]["codec"]["probe"]["url"].startswith("/media/")
    assert study["language_names"] == {"en": "English"}
    assert "random code" in study["consent"]["html"]  # the generated note


def test_instructions_wait_for_the_screen(full: Server) -> None:
    person = Person.arrive(full)
    person.agree()
    assert person.next()["step"] == "screen"
    early = person.post("instructions", submission_id=new_id())
    assert early.status_code == 409 and error_code(early) == "out_of_order"


@pytest.mark.parametrize(
    ("changes", "verdict", "codes"),
    [
        ({}, "passed", []),
        ({"refresh_hz": 144.0}, "flagged", ["refresh"]),
        ({"refresh_hz": 59.0}, "passed", []),  # 1.7 % off: measured, not another rate
        ({"refresh_hz": None}, "flagged", ["refresh"]),
        ({"codec_plays": False}, "refused", ["codec"]),
        ({"viewing_distance_mm": 200}, "refused", ["distance"]),
        ({"css_px_per_mm": 14.0}, "refused", ["px_per_degree"]),
        ({"environment": {**ENVIRONMENT, "viewport_w": 600}}, "refused", ["viewport"]),
        ({"environment": {**ENVIRONMENT, "is_mobile": True}}, "refused", ["phone"]),
        # 640 x 480 are CSS px whatever the pixel ratio is.
        (
            {"environment": {**ENVIRONMENT, "viewport_w": 640, "device_pixel_ratio": 1.5}},
            "passed",
            [],
        ),
    ],
)
def test_the_screen_is_judged(
    full: Server, changes: dict[str, Any], verdict: str, codes: list[str]
) -> None:
    person = Person.arrive(full)
    person.agree()
    reply = person.post("screen", **screen(**changes))
    assert reply.status_code == 201
    told = reply.json()
    assert (told["verdict"], [p["code"] for p in told["problems"]]) == (verdict, codes)
    for_good = {"codec", "phone"} & set(codes)
    step = person.next()
    assert step["step"] == (
        "screened_out" if for_good else "screen" if verdict == "refused" else "instructions"
    )
    if for_good:
        assert step["completion"] == {"kind": "screened_out", "code": "OUT", "return_url": None}
        assert step["screen_problems"] == [{"code": codes[0], "fixable": False}]


@pytest.mark.parametrize(
    ("asked", "ratio", "across", "needed"),
    [
        (None, 1, 1, (64, 48)),
        (None, 1.5, 1, (43, 32)),  # 42.67 CSS px hold 64 device px only in a window of 43
        (None, 2, 2, (64, 24)),
        ([50, 40], 1, 1, (64, 48)),  # less than the clips need
        ([50, 40], 2, 1, (50, 40)),
    ],
)
def test_a_window_needs_room_for_its_clips_or_what_the_study_asks_for(
    set_dir: Path, asked: list[int] | None, ratio: float, across: int, needed: tuple[int, int]
) -> None:
    clips = load_stimulus_set(set_dir).stimuli
    rules = ScreenRules("allow", asked, "ignore", False, "off", "off", None, None)
    assert needed_viewport(rules, clips, across, ratio) == needed


def test_a_mended_screen_is_accepted_and_its_density_kept(full: Server) -> None:
    person = Person.arrive(full)
    person.agree()
    person.post("screen", **screen(viewing_distance_mm=200))
    body = screen()
    density = person.post("screen", **body).json()["px_per_degree"]
    assert density == pytest.approx(3.8 * 1.25 * 600 * 0.0174538, rel=1e-4)  # device px
    again = person.post("screen", **body)
    assert again.status_code == 200 and again.json()["verdict"] == "passed"
    rows = full.query("SELECT px_per_degree FROM session WHERE session_id = ?", person.session_id)
    assert rows == [(density,)]
    checks = full.query(
        "SELECT verdict FROM screen_check WHERE session_id = ? ORDER BY check_id",
        person.session_id,
    )
    assert checks == [("refused",), ("passed",)]


def test_practice_says_whether_the_answer_was_right(full: Server) -> None:
    for value, correct in ((1, True), (0, False)):
        person = at_trials(full)
        assert person.trial()["trial_kind"] == "practice" and person.trial()["feedback"]
        body = {
            "submission_id": new_id(),
            "trial_id": person.trial()["trial_id"],
            "presentation": presentation(),
            "responses": answers(plausible=value),
        }
        reply = person.post("trials", **body)
        assert reply.json()["feedback"] == {"correct": correct, "text": None}
        assert person.post("trials", **body).json()["feedback"]["correct"] is correct
        assert trial(person, answers()).json()["feedback"] is None  # a test trial


def test_conditions_are_told_and_enforced(full: Server) -> None:
    person = at_trials(full)
    shown = person.trial()
    assert shown["conditions"] == {
        "laws": {"question": "realism", "item": "", "op": "<=", "value": 3},
        "where": {"question": "plausible", "item": "", "op": "==", "value": 0},
    }
    laws = [
        {**response("laws", 1, "kept"), "item": "gravity"},
        {**response("laws", None, "cannot_tell"), "item": "solid"},
    ]
    hidden = trial(person, answers(realism=5, more=laws))
    assert hidden.status_code == 422
    assert "laws: is not asked after these answers" in hidden.text
    missing = trial(person, answers(realism=2))
    assert missing.status_code == 422 and "laws: gravity: needs an answer" in missing.text
    marks = [{**response("where", 133.5), "item": "m1"}]
    taken = trial(person, answers(realism=2, plausible=0, more=laws + marks), num_mark_plays=2)
    assert taken.status_code == 201, taken.text
    stored = full.query(
        "SELECT key, item, value, value_text FROM response JOIN question USING (question_id) "
        "WHERE key IN ('laws', 'where') ORDER BY response_id DESC LIMIT 3"
    )
    assert sorted(stored) == [
        ("laws", "gravity", 1, "kept"),
        ("laws", "solid", None, "cannot_tell"),
        ("where", "m1", 133.5, None),
    ]


def test_last_questions_complete_the_session(full: Server) -> None:
    person = at_trials(full)
    step = finish(person)
    assert step["step"] == "end_questions" and step["completion"] is None
    early = person.post("end_questions", submission_id=new_id(), responses=[])
    assert early.status_code == 422 and "age: needs an answer" in early.text
    last = [
        {**response("age", None, "old"), "rt_origin": "form_shown"},
        {**response("last", None, "thanks"), "rt_origin": "form_shown"},
    ]
    body = {"submission_id": new_id(), "responses": last}
    assert person.post("end_questions", **body).status_code == 201
    assert person.post("end_questions", **body).status_code == 200
    other = person.post("end_questions", submission_id=new_id(), responses=last)
    assert error_code(other) == "already_answered"
    step = person.next()
    url = "https://example.org/complete?cc=DONE42"
    assert step["completion"] == {"kind": "complete", "code": "DONE42", "return_url": url}
    assert step["completion_code"] == "DONE42" and step["language"] == "en"
    stored = full.query(
        "SELECT key, value_text FROM session_answer JOIN question USING (question_id) "
        "WHERE participant_id = ? ORDER BY key",
        person.participant_id,
    )
    assert stored == [("age", "old"), ("last", "thanks")]


def test_a_text_from_the_end_can_be_redacted(full: Server) -> None:
    person = at_trials(full)
    finish(person)
    words = "call me at 555 0100"
    responses = [response("age", None, "old"), response("last", None, words)]
    for answer in responses:
        answer["rt_origin"] = "form_shown"
    reply = person.post("end_questions", submission_id=new_id(), responses=responses)
    assert reply.status_code == 201
    [(number,)] = full.query("SELECT answer_id FROM session_answer WHERE value_text = ?", words)
    engine = writing_engine(Path(full.db))
    with engine.begin() as connection:
        assert redact_remark(connection, number, reason="a number", actor="ada")
        assert not redact_remark(connection, number, reason="a number", actor="ada")
        # What is no free text cannot be redacted.
        assert not redact_remark(connection, number - 1, reason="age", actor="ada")
    engine.dispose()
    kept = full.query("SELECT value_text FROM session_answer WHERE answer_id >= ?", number - 1)
    assert kept == [("old",), ("[redacted]",)]
    logged = full.query("SELECT body FROM submission WHERE kind = 'end_questions'")
    assert words not in str(logged) and ("",) in logged


def test_stopping_early_keeps_the_answers_and_pays_from_its_share_on(full: Server) -> None:
    soon, later = at_trials(full), at_trials(full)
    for _ in range(3):
        trial(later, answers())
    for person, code in ((soon, None), (later, "PART")):
        assert person.post("stop", submission_id=new_id()).status_code == 201
        step = person.next()
        assert step["step"] == "stopped" and step["completion"]["code"] == code
        assert step["completion"]["kind"] == "partial"
    state = "SELECT state, count(answered_utc) FROM participant JOIN trial USING (participant_id)"
    state += " WHERE participant_id = ?"
    assert full.query(state, later.participant_id) == [("stopped", 3)]
    late = later.post("stop", submission_id=new_id())
    assert late.status_code == 409 and error_code(late) == "cannot_stop"


def rows_left(server: Server, person: Person) -> int:
    return sum(
        server.query(f"SELECT count(*) FROM {table} WHERE participant_id = ?",
                     person.participant_id)[0][0]
        for table in ("participant", "session", "trial", "consent", "assignment", "session_answer",
                      "participant_link")
    )  # fmt: skip


def test_withdrawing_by_token_deletes_everything_at_once(full: Server) -> None:
    secret = "a sentence that must be gone"
    person = at_trials(full)
    trial(person, answers(more=[response("note", None, secret)]))
    assert person.post("withdraw", submission_id=new_id(), confirm=False).status_code == 422
    reply = person.post("withdraw", submission_id=new_id(), confirm=True)
    assert reply.status_code == 200 and reply.json() == {"erased": True}
    assert person.client.get("/api/next").status_code == 401
    assert rows_left(full, person) == 0
    folder = Path(full.db).parent
    assert not any(secret.encode() in file.read_bytes() for file in folder.glob("full.db*"))
    notes = full.query("SELECT reason, num_rows FROM erasure ORDER BY erasure_id DESC LIMIT 1")
    assert notes == [("participant", 5)]
    log = full.query("SELECT actor, detail_json FROM admin_audit ORDER BY audit_id DESC LIMIT 1")
    assert log[0][0] == "participant" and person.participant_id not in log[0][1]


def test_the_link_of_the_debrief_page_deletes_and_works_once(full: Server) -> None:
    person = at_trials(full)
    trial(person, answers())
    person.post("stop", submission_id=new_id())
    fragment = person.next()["withdraw_fragment"]
    withdrawal = fragment.removeprefix("withdraw=")
    with full.client() as client:

        def post(secret: str) -> Any:
            body = {"submission_id": new_id(), "withdrawal": secret}
            return client.post("/api/withdraw_by_link", json=body)

        other = withdrawal[:-1] + ("0" if withdrawal[-1] != "0" else "1")
        assert post(other).status_code == 404
        assert rows_left(full, person) > 0
        assert post(withdrawal).json() == {"erased": True}
        assert rows_left(full, person) == 0
        assert error_code(post(withdrawal)) == "withdrawal_unknown"


def test_a_study_speaks_german(set_dir: Path, tmp_path: Path) -> None:
    import verisim.study

    source = Path(verisim.study.__file__).parent / "studies" / "realism_ratings.yaml"
    text = source.read_text().replace("set: demo", "set: mini").replace("texts/", "")
    start = text.index("order:")
    text = text[:start] + "order: {sampler: random, seed: 1}\n" + text[text.index("completion:") :]
    study = tmp_path / "german.yaml"
    study.write_text(text)
    for file in (source.parent / "texts").glob("*.md"):
        (tmp_path / file.name).write_text(file.read_text())
    with Server(study, set_dir, tmp_path / "g.db") as server:
        with server.client() as client:
            page = client.get("/api/study?lang=de").json()
            english = client.get("/api/study?lang=fr").json()
        assert page["language"] == "de" and english["language"] == "en"
        assert page["questions"][0]["prompt"].startswith("Wie realistisch")
        assert "Zufallscode" in page["consent"]["html"]
        assert (page["title"], english["title"]) == (
            "Wie echt bewegt es sich?",
            "How real does it move?",
        )
        assert "die Person, die Sie eingeladen hat" in page["consent"]["html"]
        assert "die Person" not in english["consent"]["html"]
        person = Person.arrive(server)
        form = page["consent"]
        agreed = person.agree(
            language="de", form_version=form["version"], form_sha256=form["sha256"]
        )
        assert agreed.status_code == 201 and person.next()["language"] == "de"


def test_the_note_on_data_speaks_of_every_stored_column() -> None:
    from verisim.study.server.data_note import columns_stored, columns_told

    assert columns_told() == columns_stored()


def test_a_study_file_whose_parts_do_not_fit_is_refused(tmp_path: Path) -> None:
    from verisim.study.server import check_study

    for change, words in (
        (("layout: single", "layout: sequential"), "pairs need a layout of two clips"),
        (
            ("kind: comment, max", "kind: comment, ask: {if: taste == 1}, max"),
            "'taste', which does",
        ),
        (("kind: comment, max_chars: 50", "kind: choice"), "a choice needs a layout of two clips"),
        (("sampler: random", "sampler: quest_plus"), "tracks: missing"),
        (
            ("kind: comment, max_chars: 50", "kind: mark"),
            "note: a mark needs a layout of one clip",
        ),
    ):
        text = PAIRS if "kind: mark" in change[1] else STUDY
        assert change[0] in text
        path = write_study(tmp_path, text.replace(*change))
        found = "\n".join(str(problem) for problem in check_study(path))
        assert words in found, found
