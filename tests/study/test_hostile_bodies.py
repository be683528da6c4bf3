# SPDX-License-Identifier: MIT
"""Bodies that no page sends: each is refused clearly, and the next good one is stored."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import httpx
import pytest
from study_tools import Person, Server, new_id, presentation, response, trial_body

from verisim.study.server.rate_limit import BURST, RateLimit

Change = Callable[[dict[str, Any]], None]


def put(*path: str | int, value: Any) -> Change:
    """Returns a change that sets one value deep in a body."""

    def change(body: dict[str, Any]) -> None:
        target: Any = body
        for part in path[:-1]:
            target = target[part]
        target[path[-1]] = value

    return change


BAD_VALUES: dict[str, Change] = {
    "an unknown key": put("extra", value=1),
    "an unknown key deep inside": put("presentation", "extra", value=1),
    "a missing key": lambda body: body.pop("trial_id"),
    "a trial_id past 2^53": put("trial_id", value=2**53),
    "a trial_id of 400 digits": put("trial_id", value=10**400),
    "a negative trial_id": put("trial_id", value=-1),
    "a true where a number belongs": put("trial_id", value=True),
    "a number as text": put("trial_id", value="1"),
    "a whole number with a fraction": put("trial_id", value=1.5),
    "frames past 2^53": put("presentation", "frames_total", value=2**53),
    "plays of 20 digits": put("presentation", "num_plays", value=10**20),
    "a time beyond all studies": put("presentation", "onset_ms", value=1e10),
    "a negative time": put("presentation", "stall_ms", value=-1),
    "a number where true belongs": put("presentation", "completed", value=1),
    "a null where a list belongs": put("responses", value=None),
    "a hundred and one responses": put("responses", value=[response("realism", 1)] * 101),
    "an answer of 300 digits": put("responses", 0, "value", value=10**300),
    "an answer as true": put("responses", 0, "value", value=True),
    "an unknown origin of rt": put("responses", 0, "rt_origin", value="birth"),
    "a comment with NUL": put("responses", 3, "value_text", value="a\0b"),
    "a comment with an escape": put("responses", 3, "value_text", value="\x1b[2J"),
    "a comment that is far too long": put("responses", 3, "value_text", value="x" * 3000),
    "a question named like SQL": put("responses", 0, "question", value="a'; DROP TABLE trial;--"),
    "an id with NUL": put("presentation", "presentation_id", value="abcdefgh\0"),
    "an id with a line end": put("submission_id", value="abcdefgh\n"),
    "an id named like SQL": put("submission_id", value="' OR 1=1 --"),
    "an id that is too long": put("submission_id", value="x" * 65),
}


@pytest.fixture(scope="module")
def person(server: Server) -> Person:
    return Person.ready(server)


@pytest.mark.parametrize("name", BAD_VALUES)
def test_a_wrong_value_is_refused_with_422(person: Person, name: str) -> None:
    body = trial_body(person.trial()["trial_id"])
    BAD_VALUES[name](body)
    reply = person.client.post("/api/trials", content=json.dumps(body))
    assert reply.status_code == 422, reply.text
    assert reply.json()["error"]["code"] == "invalid"


BAD_BYTES: dict[str, bytes] = {
    "nothing": b"",
    "no JSON": b"{",
    "a list": b"[]",
    "a number": b"1",
    "text after the JSON": b"{} {}",
    "bytes that are no UTF-8": b'{"submission_id": "\xff\xfe"}',
    "an array 30000 deep": b"[" * 30_000 + b"]" * 30_000,
    "an object 9000 deep": b'{"a":' * 9_000 + b"1" + b"}" * 9_000,
}


@pytest.mark.parametrize("name", BAD_BYTES)
@pytest.mark.parametrize("kind", ["sessions", "trials", "events"])
def test_bytes_that_are_no_body_are_refused(person: Person, kind: str, name: str) -> None:
    reply = person.client.post(f"/api/{kind}", content=BAD_BYTES[name])
    assert reply.status_code == 422, reply.text


@pytest.mark.parametrize(
    "number", ["NaN", "Infinity", "-Infinity", "1e999", "-1e999", "9" * 5000, "0x10", "1_000"]
)
def test_numbers_that_are_none_are_refused(person: Person, number: str) -> None:
    text = json.dumps(trial_body(person.trial()["trial_id"]))
    for before in ('"rt_ms": 812.5', '"trial_id": '):
        if before == '"trial_id": ':
            changed = text.replace(before, f'{before}{number}, "x": ', 1)
        else:
            changed = text.replace(before, f'"rt_ms": {number}', 1)
        reply = person.client.post("/api/trials", content=changed)
        assert reply.status_code == 422, reply.text


def test_a_lone_surrogate_is_refused(person: Person) -> None:
    body = trial_body(person.trial()["trial_id"])
    text = json.dumps(body).replace("went well", "\\ud800")
    assert person.client.post("/api/trials", content=text).status_code == 422


def test_events_with_deep_or_endless_detail_are_refused(person: Person) -> None:
    for detail in ({"a": {"b": 1}}, {"a": [1]}, {"a": 2**53}, {"a": "x" * 501}, {"A b": 1}):
        event = {"seq": 1, "presentation_id": None, "kind": "k", "t_ms": 1, "detail": detail}
        reply = person.post("events", submission_id=new_id(), events=[event])
        assert reply.status_code == 422, reply.text


def test_a_body_over_64_kib_is_refused_with_413(person: Person) -> None:
    for size, status in ((64 * 1024, 422), (64 * 1024 + 1, 413), (5_000_000, 413)):
        reply = httpx.post(
            f"{person.server.address}/api/sessions", content=b"x" * size, trust_env=False
        )
        assert reply.status_code == status


def test_a_body_of_unknown_length_is_cut_off_at_64_kib(person: Person) -> None:
    def chunks() -> Any:
        for _ in range(20):
            yield b"x" * 8192

    try:
        reply = httpx.post(
            f"{person.server.address}/api/sessions", content=chunks(), trust_env=False
        )
    except httpx.TransportError:
        return  # closed while we were still sending: refused as well
    assert reply.status_code == 413


def test_wrong_methods_and_paths_are_refused(person: Person) -> None:
    assert person.client.get("/api/trials").status_code == 405
    assert person.client.post("/api/nothing", json={}).status_code == 404
    assert person.client.get("/docs").status_code == 404
    assert person.client.get("/openapi.json").status_code == 404


def test_an_answer_to_a_hostile_body_shows_none_of_it(person: Person) -> None:
    body = trial_body(person.trial()["trial_id"], submission_id="<script>alert(1)</script>")
    reply = person.post("trials", **body)
    assert "script" not in reply.text and reply.headers["content-type"] == "application/json"


def test_after_all_that_good_answers_are_stored(person: Person) -> None:
    shown = presentation(onset_ms=1e9, frames_total=2**53 - 1)
    body = trial_body(person.trial()["trial_id"], presentation=shown)
    assert person.post("trials", **body).status_code == 201
    assert person.client.get("/readyz").status_code == 200
    assert person.server.query("PRAGMA integrity_check") == [("ok",)]
    frames = person.server.query(
        "SELECT frames_total FROM presentation WHERE presentation_id = ?",
        shown["presentation_id"],
    )
    assert frames == [(2**53 - 1,)]


def test_every_answer_carries_the_security_headers(person: Person) -> None:
    clip = person.trial()["clips"][0]["url"]
    for path in ("/", "/api/study", "/api/next", "/nothing", clip, "/healthz"):
        headers = person.client.get(path).headers
        assert headers["x-content-type-options"] == "nosniff", path
        assert headers["referrer-policy"] == "no-referrer"
        assert "frame-ancestors 'none'" in headers["content-security-policy"]
        assert "media-src 'self' blob:" in headers["content-security-policy"]
        assert headers["cross-origin-resource-policy"] == "same-origin"
        assert "server" not in headers
    assert person.client.get("/api/next").headers["cache-control"] == "no-store"
    assert person.client.get("/").headers["cache-control"] == "no-store"


def test_the_rate_limit_stops_a_loop_and_spares_others() -> None:
    limit = RateLimit()
    allowed = sum(limit.allows("loop") for _ in range(int(BURST) + 200))
    assert BURST <= allowed < BURST + 100  # a few tokens refill meanwhile
    assert limit.allows("person")
