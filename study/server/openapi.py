# SPDX-License-Identifier: MIT
"""The HTTP interface as an OpenAPI document, made from the bodies that the server checks."""

from __future__ import annotations

from typing import Any

from verisim.study.server import bodies
from verisim.study.server.app import POSTS

WITHOUT_TOKEN: dict[str, type[bodies.Body]] = {
    "sessions": bodies.SessionBody,
    "withdraw_by_link": bodies.WithdrawByLinkBody,
}
REPLIES = {
    "200": "done before, or read",
    "201": "on the disk",
    "401": "no or unknown token",
    "403": "not yours, or not admitted",
    "409": "answered before, or not the next step",
    "413": "too large",
    "422": "not as described here",
    "429": "too many requests; try again",
    "503": "busy; try again",
    "507": "disk full; try again",
}


def describe_api() -> dict[str, Any]:
    """Returns the OpenAPI 3.1 document of the participants' interface."""
    schemas: dict[str, Any] = {}
    paths: dict[str, Any] = {}
    models = {kind: model for kind, (model, _) in POSTS.items()}
    models |= {**WITHOUT_TOKEN, "withdraw": bodies.WithdrawBody}
    for kind, model in sorted(models.items()):
        schema = model.model_json_schema(ref_template="#/components/schemas/{model}")
        schemas |= schema.pop("$defs", {})
        schemas[model.__name__] = schema
        paths[f"/api/{kind}"] = {
            "post": {
                "security": [] if kind in WITHOUT_TOKEN else [{"token": []}],
                "requestBody": {
                    "required": True,
                    "content": {
                        "application/json": {
                            "schema": {"$ref": f"#/components/schemas/{model.__name__}"}
                        }
                    },
                },
                "responses": {code: {"description": text} for code, text in REPLIES.items()},
            }
        }
    secured: list[tuple[str, list[dict[str, list[str]]]]] = [
        ("study", []),
        ("next", [{"token": []}]),
    ]
    for kind, security in secured:
        paths[f"/api/{kind}"] = {
            "get": {"security": security, "responses": {"200": {"description": REPLIES["200"]}}}
        }
    return {
        "openapi": "3.1.0",
        "info": {"title": "Verisim study server", "version": "1"},
        "paths": paths,
        "components": {
            "schemas": schemas,
            "securitySchemes": {"token": {"type": "http", "scheme": "bearer"}},
        },
    }
