# SPDX-License-Identifier: MIT
"""A participant's way through the study: steps, order, resume, and what is refused on the way."""

from __future__ import annotations

import httpx
from study_tools import (
    Person,
    Server,
    error_code,
    new_id,
    presentation,
    response,
    session_body,
    trial_body,
)


def test_a_participant_goes_from_consent_to_thanks(server: Server) -> None:
    person = Person.arrive(server)
    assert person.next()["step"] == "consent"
    person.agree()
    assert person.next()["step"] == "instructions"
    person.post("instructions", submission_id=new_id())
    kinds, rests, firsts = [], [], []
    while (step := person.next())["step"] == "trial":
        trial = step["trial"]
        kinds.append(trial["trial_kind"])
        rests.append(trial["rest_before"])
        firsts.append(trial["first_of_kind"])
        assert step["progress"] == {"done": len(kinds) - 1, "total": 8}
        person.post("trials", **trial_body(trial["trial_id"]))
    assert step["step"] == "thanks" and len(step["completion_code"]) == 11
    assert kinds[0] == "practice" and kinds[1] != "catch" and sorted(kinds[1:])[0] == "catch"
    assert firsts == [True, True] + [False] * 6
    assert rests == [False, False, False, False, True, False, False, True]  # rest_every: 3
    assert server.query(
        "SELECT state FROM participant WHERE participant_id = ?", person.participant_id
    ) == [("completed",)]


def test_the_study_page_learns_what_the_contract_names(server: Server) -> None:
    study = httpx.get(f"{server.address}/api/study?lang=xx", trust_env=False).json()
    assert study["language"] == "en" and study["consent"]["version"] == "3"
    assert "Ask the tester" in study["consent"]["html"]
    assert (study["num_trials"], study["num_practice"]) == (7, 1)
    assert study["simulated_notice"] is None
    assert study["trial"]["lock"] == "first_play" and study["trial"]["fixation_ms"] == [0, 100]
    assert [q["kind"] for q in study["questions"]] == ["rating", "bipolar", "slider", "comment"]
    assert study["questions"][1]["labels"] == ["too slow", "", "right", "", "too fast"]
    assert study["questions"][3]["optional"] and study["questions"][3]["max_chars"] == 50


def test_a_reload_goes_on_at_the_first_unanswered_trial(server: Server) -> None:
    person = Person.ready(server)
    person.answer_next()
    person.answer_next()
    shown = person.trial()
    broken_off = presentation(completed=False, ended_ms=None)
    body = {"submission_id": new_id(), "trial_id": shown["trial_id"], "presentation": broken_off}
    assert person.post("presentations", **body).status_code == 201
    again = Person(server, person.token, "", "", server.client(person.token)).trial()
    assert again == shown and again["trial_index"] == 2
    person.answer_next()
    showings = server.query(
        "SELECT completed FROM presentation WHERE trial_id = ? ORDER BY completed",
        shown["trial_id"],
    )
    assert showings == [(0,), (1,)]


def test_a_showing_reported_as_broken_off_may_still_be_completed(server: Server) -> None:
    person = Person.ready(server)
    trial_id = person.trial()["trial_id"]
    shown = presentation(completed=False, ended_ms=None)
    person.post("presentations", submission_id=new_id(), trial_id=trial_id, presentation=shown)
    shown = {**shown, "completed": True, "ended_ms": 400.0}
    assert person.post("trials", **trial_body(trial_id, presentation=shown)).status_code == 201
    rows = server.query("SELECT completed, ended_ms FROM presentation WHERE trial_id = ?", trial_id)
    assert rows == [(1, 400.0)]


def test_trials_can_be_answered_only_in_the_servers_order(server: Server) -> None:
    person = Person.ready(server)
    first = person.trial()["trial_id"]
    reply = person.post("trials", **trial_body(first + 1))
    assert (reply.status_code, error_code(reply)) == (409, "out_of_order")


def test_nothing_can_be_answered_before_consent(server: Server) -> None:
    person = Person.arrive(server)
    trial_id = server.query(
        "SELECT min(trial_id) FROM trial WHERE participant_id = ?", person.participant_id
    )[0][0]
    assert error_code(person.post("trials", **trial_body(trial_id))) == "out_of_order"
    assert error_code(person.post("instructions", submission_id=new_id())) == "out_of_order"


def test_who_declines_is_thanked_and_asked_nothing(server: Server) -> None:
    person = Person.arrive(server)
    assert person.agree(agreed=False).status_code == 201
    assert person.next()["step"] == "declined"
    assert error_code(person.agree()) == "already_answered"


def test_consent_to_another_form_is_refused(server: Server) -> None:
    person = Person.arrive(server)
    reply = person.agree(form_sha256="0" * 64)
    assert (reply.status_code, error_code(reply)) == (422, "other_form")
    assert person.next()["step"] == "consent"


def test_another_participants_trial_is_refused(server: Server) -> None:
    owner, other = Person.ready(server), Person.ready(server)
    trial_id = owner.trial()["trial_id"]
    for kind, body in (
        ("trials", trial_body(trial_id)),
        (
            "presentations",
            {
                "submission_id": new_id(),
                "trial_id": trial_id,
                "presentation": presentation(completed=False),
            },
        ),
    ):
        reply = other.post(kind, **body)
        assert (reply.status_code, error_code(reply)) == (403, "not_yours")
    assert server.query("SELECT answered_utc FROM trial WHERE trial_id = ?", trial_id) == [(None,)]


def test_another_participants_presentation_is_never_overwritten(server: Server) -> None:
    owner, other = Person.ready(server), Person.ready(server)
    shown = presentation()
    owner.post("trials", **trial_body(owner.trial()["trial_id"], presentation=shown))
    body = trial_body(other.trial()["trial_id"], presentation={**shown, "num_plays": 9})
    assert other.post("trials", **body).status_code == 403
    rows = server.query(
        "SELECT num_plays FROM presentation WHERE presentation_id = ?", shown["presentation_id"]
    )
    assert rows == [(1,)]


def test_unknown_and_missing_tokens_are_refused(server: Server) -> None:
    for headers in ({}, {"authorization": "Bearer nonsense"}, {"authorization": "Basic x"}):
        with server.client() as client:
            assert client.get("/api/next", headers=headers).status_code == 401
            body = trial_body(1)
            assert client.post("/api/trials", json=body, headers=headers).status_code == 401


def test_the_token_is_stored_only_as_a_hash(server: Server) -> None:
    person = Person.arrive(server)
    assert len(person.token) >= 43  # 256 bits in base64
    stored = server.db.read_bytes() + server.db.with_name(server.db.name + "-wal").read_bytes()
    assert person.token.encode() not in stored
    assert b"127.0.0.1" not in stored


def test_a_repeated_session_submission_opens_no_second_session(server: Server) -> None:
    body = session_body()
    with server.client() as client:
        assert client.post("/api/sessions", json=body).status_code == 201
        reply = client.post("/api/sessions", json=body)
    assert (reply.status_code, error_code(reply)) == (409, "duplicate_session")


def test_only_the_servers_key_marks_a_participant_as_simulated(server: Server) -> None:
    with server.client() as client:
        for changes in (
            {"source": "simulated"},
            {"source": "simulated", "simulate_key": "guess"},
            {"source": "link", "simulate_key": "guess"},
        ):
            reply = client.post("/api/sessions", json=session_body(**changes))
            assert (reply.status_code, error_code(reply)) == (403, "not_simulated")


def test_a_participant_without_a_source_gets_the_servers_default(server: Server) -> None:
    person = Person.arrive(server, source=None)
    rows = server.query(
        "SELECT source FROM participant WHERE participant_id = ?", person.participant_id
    )
    assert rows == [("lab",)]


def test_impossible_answers_are_refused_all_at_once(server: Server) -> None:
    person = Person.ready(server)
    answers = [
        response("realism", 8),
        response("speed", 2.5),
        response("fun", None),
        response("note", None, "x" * 51),
        response("taste", 1),
        response("realism", 1),
    ]
    reply = person.post("trials", **trial_body(person.trial()["trial_id"], responses=answers))
    assert reply.status_code == 422
    message = reply.json()["error"]["message"]
    for fault in (
        "realism: 8",
        "speed: 2.5",
        "fun: needs",
        "note: has 51",
        "taste: unknown",
        "realism: answered twice",
    ):
        assert fault in message, message


def test_an_answer_needs_a_clip_played_to_its_end(server: Server) -> None:
    person = Person.ready(server)
    shown = presentation(completed=False)
    reply = person.post("trials", **trial_body(person.trial()["trial_id"], presentation=shown))
    assert reply.status_code == 422 and "played to its end" in reply.text


def test_a_skipped_comment_leaves_no_row(server: Server) -> None:
    person = Person.ready(server)
    trial_id = person.trial()["trial_id"]
    answers = [response("realism", 1), response("speed", 5), response("fun", 0)]
    answers.append(response("note", None, "  "))
    assert person.post("trials", **trial_body(trial_id, responses=answers)).status_code == 201
    assert server.query("SELECT count(*) FROM response WHERE trial_id = ?", trial_id) == [(3,)]
    assert server.query("SELECT count(*) FROM comment WHERE trial_id = ?", trial_id) == [(0,)]


def test_events_are_stored_once_per_number(server: Server) -> None:
    person = Person.ready(server)
    event = {"seq": 1, "presentation_id": None, "kind": "hidden", "t_ms": 5, "detail": {"n": 1}}
    later = {**event, "seq": 2, "detail": None}
    for events in ([event], [event, later]):
        assert person.post("events", submission_id=new_id(), events=events).status_code == 201
    rows = server.query(
        "SELECT seq, kind, detail_json FROM event WHERE session_id = ? ORDER BY seq",
        person.session_id,
    )
    assert rows == [(1, "hidden", '{"n": 1}'), (2, "hidden", None)]


def test_the_order_is_reproduced_from_its_stored_seed(server: Server) -> None:
    from verisim.study.server.enrolment import order_sha256
    from verisim.study.server.samplers import plan_order
    from verisim.study.server.stimulus_set import load_stimulus_set
    from verisim.study.server.study_file import load_study

    people = [Person.arrive(server) for _ in range(3)]
    study = load_study(server.study)
    stimuli = load_stimulus_set(server.set_dir).stimuli
    orders = []
    for person in people:
        seed, digest, list_no = server.query(
            "SELECT seed, order_sha256, list_no FROM assignment WHERE participant_id = ?",
            person.participant_id,
        )[0]
        # The manifest's order does not matter.
        turned = list(reversed(stimuli))
        plan = plan_order(study.order, turned, study.trial.layouts, seed, list_no, "")
        shown = server.query(
            "SELECT trial_kind, name FROM trial JOIN stimulus ON stimulus_id = stimulus_a "
            "WHERE participant_id = ? ORDER BY trial_index",
            person.participant_id,
        )
        assert shown == [(trial.trial_kind, trial.clips[0]) for trial in plan]
        assert digest == order_sha256(plan)
        orders.append(tuple(shown))
    assert len(set(orders)) == 3


def test_health_and_readiness_answer(server: Server) -> None:
    with server.client() as client:
        assert client.get("/healthz").json() == {"status": "alive"}
        assert client.get("/readyz").json() == {"status": "ready"}
    assert server.query("SELECT count(*) FROM heartbeat") == [(1,)]
