# SPDX-License-Identifier: MIT
"""A scripted rater's side of the HTTP interface: JSON in and out, retries as the page does."""

from __future__ import annotations

import time
import uuid
from types import TracebackType
from typing import Any

import httpx

from verisim.study.problems import refuse

DEADLINE_S = 15.0
MAX_TRIES = 20
PASSING = (429, 503, 507)  # what waiting can cure


class HttpClient:
    """One participant's connection."""

    def __init__(self, address: str, token: str = "") -> None:
        # No proxy of the environment: the server is on this machine.
        self._client = httpx.Client(base_url=address, timeout=DEADLINE_S, trust_env=False)
        self._token = token

    def get(self, path: str) -> dict[str, Any]:
        return self._json(self._request("GET", path))

    def get_bytes(self, path: str) -> bytes:
        return self._request("GET", path).content

    def post(self, path: str, **body: Any) -> dict[str, Any]:
        """Sends a body under a new submission_id; every repeat of it carries the same one."""
        return self._json(self._request("POST", path, {"submission_id": self.new_id(), **body}))

    @staticmethod
    def new_id() -> str:
        return str(uuid.uuid4())

    def _request(self, method: str, path: str, body: Any = None) -> httpx.Response:
        headers = {"authorization": f"Bearer {self._token}"} if self._token else {}
        response: httpx.Response | None = None
        for attempt in range(MAX_TRIES):
            try:
                response = self._client.request(method, path, json=body, headers=headers)
            except httpx.TransportError as error:
                if attempt == MAX_TRIES - 1:
                    raise refuse(path, f"no answer from the server: {error}") from error
            else:
                if response.status_code not in PASSING:
                    break
            time.sleep(min(1.0, 0.05 * 2**attempt))
        assert response is not None
        if response.status_code >= 400:
            raise refuse(path, f"the server answered {response.status_code}: {response.text[:300]}")
        return response

    @staticmethod
    def _json(response: httpx.Response) -> dict[str, Any]:
        document = response.json()
        assert isinstance(document, dict)
        return document

    def __enter__(self) -> HttpClient:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._client.close()
