# SPDX-License-Identifier: MIT
"""Every endpoint under bodies made from its own OpenAPI schema: never a 5xx, never a hang."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from schema_bodies import almost, fitting
from study_tools import FULL, Person, Server, new_id, write_study
from test_steps import at_trials

from verisim.study.server.openapi import describe_api

DOCUMENT = describe_api()
POSTS = sorted(path for path, acts in DOCUMENT["paths"].items() if "post" in acts)
ALLOWED = {200, 201, 400, 401, 403, 404, 409, 413, 422, 429}


@pytest.fixture(scope="module")
def fuzzed(set_dir: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    study = write_study(tmp_path_factory.mktemp("fuzz"), FULL)
    with Server(study, set_dir, tmp_path_factory.mktemp("db") / "fuzz.db") as server:
        yield server


def body_of(path: str) -> dict[str, Any]:
    content = DOCUMENT["paths"][path]["post"]["requestBody"]["content"]
    return dict(content["application/json"]["schema"])


def encode(value: Any) -> bytes:
    return json.dumps(value).encode("utf-8", "surrogatepass")


def test_the_document_names_every_route_and_refuses_what_is_unknown() -> None:
    assert len(POSTS) == 11
    for schema in DOCUMENT["components"]["schemas"].values():
        if schema.get("type") == "object":
            assert schema.get("additionalProperties") is False, schema["title"]


def person_at(server: Server, path: str) -> Person:
    """Somebody for whom this path is the next step, so that bodies get past the door."""
    if path in ("/api/consent", "/api/sessions"):
        return Person.arrive(server)
    if path in ("/api/screen", "/api/instructions"):
        person = Person.arrive(server)
        assert person.agree().status_code == 201
        return person
    return at_trials(server)


def made_own(body: Any, trial: dict[str, Any] | None) -> Any:
    """The body as if about the caller's own trial, its clips and the study's questions."""
    if trial is None or not isinstance(body, dict) or "trial_id" not in body:
        return body
    own = {**body, "trial_id": trial["trial_id"]}
    shown, given = own.get("presentation"), own.get("responses")
    if isinstance(shown, dict) and isinstance(shown.get("clips"), list):
        sha256 = trial["clips"][0]["sha256"]
        clips = [{**c, "sha256": sha256} if isinstance(c, dict) else c for c in shown["clips"]]
        own["presentation"] = {**shown, "clips": clips, "presentation_id": new_id()}
    if isinstance(given, list):
        keys = trial["question_keys"]
        own["responses"] = [
            {**response, "question": keys[i % len(keys)]}
            if isinstance(response, dict)
            else response
            for i, response in enumerate(given)
        ]
    return own


@pytest.mark.parametrize("path", POSTS)
def test_no_body_makes_the_server_fail(fuzzed: Server, path: str) -> None:
    person = person_at(fuzzed, path)
    trial = person.trial() if path in ("/api/trials", "/api/presentations") else None
    schema = fitting(body_of(path), DOCUMENT)
    answered: set[int] = set()

    @settings(
        max_examples=30,
        deadline=None,
        derandomize=True,
        suppress_health_check=list(HealthCheck),
    )
    @given(st.one_of(schema, almost(schema)), st.booleans())
    def post(body: Any, is_own: bool) -> None:
        body = made_own(body, trial) if is_own else body
        reply = person.client.post(path, content=encode(body))
        answered.add(reply.status_code)
        assert reply.status_code in ALLOWED, (reply.status_code, reply.text, body)
        assert "error" not in reply.json() or set(reply.json()["error"]) == {
            "code",
            "message",
            "hint",
        }

    post()
    assert 422 in answered or answered <= {401, 429}
    with fuzzed.client() as client:
        assert client.get("/readyz").status_code == 200
    assert Person.arrive(fuzzed).agree().status_code == 201  # the next good one works


def test_no_question_or_token_makes_the_server_fail(fuzzed: Server) -> None:
    """The endpoints that are read: any language asked for, any token shown."""
    latin = st.text(st.characters(min_codepoint=32, max_codepoint=126), max_size=200)

    @settings(
        max_examples=60,
        deadline=None,
        derandomize=True,
        suppress_health_check=list(HealthCheck),
    )
    @given(st.text(max_size=300), latin, st.sampled_from(("/api/study", "/api/next")))
    def get(lang: str, token: str, path: str) -> None:
        query = {"lang": lang.encode("utf-8", "replace").decode()}
        reply = client.get(path, params=query, headers={"authorization": f"Bearer x{token}x"})
        assert reply.status_code == (200 if path == "/api/study" else 401), reply.text

    with fuzzed.client() as client:
        get()
