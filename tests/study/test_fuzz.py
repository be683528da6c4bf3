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
from study_tools import FULL, Person, Server, write_study

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


@pytest.mark.parametrize("path", POSTS)
def test_no_body_makes_the_server_fail(fuzzed: Server, path: str) -> None:
    person = Person.arrive(fuzzed)
    schema = fitting(body_of(path), DOCUMENT)
    answered: set[int] = set()

    @settings(
        max_examples=30,
        deadline=None,
        derandomize=True,
        suppress_health_check=list(HealthCheck),
    )
    @given(st.one_of(schema, almost(schema)))
    def post(body: Any) -> None:
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
