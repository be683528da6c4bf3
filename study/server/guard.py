# SPDX-License-Identifier: MIT
"""Wraps the application: body cap, deadline, rate limit, safe headers, log without addresses."""

from __future__ import annotations

import asyncio
import hashlib
import json
import logging
from typing import Any

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from verisim.study.server.api_error import ApiError
from verisim.study.server.rate_limit import RateLimit

access_log = logging.getLogger("verisim.study.access")

MAX_BODY_BYTES = 64 * 1024
DEADLINE_S = 10.0  # the page gives up after 15
EXPORT_DEADLINE_S = 600.0

CONTENT_SECURITY_POLICY = (
    "default-src 'self'; media-src 'self' blob:; img-src 'self' data:; connect-src 'self' blob:; "
    "style-src 'self' 'unsafe-inline'; font-src 'self' data:; object-src 'none'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
SECURITY_HEADERS = [
    (b"content-security-policy", CONTENT_SECURITY_POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"x-frame-options", b"DENY"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"permissions-policy", b"camera=(), microphone=(), geolocation=(), interest-cohort=()"),
]
FORM_HEADERS = [
    (
        b"content-security-policy",
        b"default-src 'none'; style-src 'unsafe-inline'; form-action 'self'; base-uri 'none'; "
        b"frame-ancestors 'none'",
    ),
    *SECURITY_HEADERS[1:],
]


class Guard:
    """The outermost layer; whatever passes it is small, in time and answered with safe headers."""

    def __init__(self, app: ASGIApp, *, forms: bool = False) -> None:
        """forms: the pages hold HTML forms, which may be sent to this server alone."""
        self._app = app
        self._forms = forms
        self._limit = RateLimit()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        answer = Answer(send, forms=self._forms)
        try:
            if not is_timed(scope["path"]):
                await self._app(scope, receive, answer.send)
            else:
                if not self._limit.allows(caller_name(scope)):
                    raise ApiError(429, "too_many", "too many requests", "wait a second")
                async with asyncio.timeout(deadline_s(scope["path"])):
                    body = await read_body(scope, receive)
                    await self._app(scope, replay(body, receive), answer.send)
        except ApiError as error:
            await answer.refuse(error)
        except TimeoutError:
            await answer.refuse(
                ApiError(503, "busy", "the server did not answer in time", "try again in a moment")
            )
        access_log.info("%s %s %s", scope["method"], scope["path"], answer.status)


class Answer:
    """Adds headers to what the application sends and remembers whether it has begun."""

    def __init__(self, send: Send, *, forms: bool = False) -> None:
        self._send = send
        self._headers = FORM_HEADERS if forms else SECURITY_HEADERS
        self.status: int | None = None

    async def send(self, message: Message) -> None:
        if message["type"] == "http.response.start":
            self.status = message["status"]
            headers = [*message.get("headers", []), *self._headers]
            if not any(name == b"cache-control" for name, _ in headers):
                headers.append((b"cache-control", b"no-store"))
            message = {**message, "headers": headers}
        await self._send(message)

    async def refuse(self, error: ApiError) -> None:
        if self.status is not None:
            return  # headers are out; the connection ends short and the page retries
        content = json.dumps(error.body()).encode()
        headers = [
            (b"content-type", b"application/json"),
            (b"content-length", str(len(content)).encode()),
        ]
        if error.status in (429, 503):
            headers.append((b"retry-after", b"1"))
        await self.send({"type": "http.response.start", "status": error.status, "headers": headers})
        await self._send({"type": "http.response.body", "body": content})


def deadline_s(path: str) -> float:
    """An export of much data takes its time; everything else must be quick."""
    return EXPORT_DEADLINE_S if path == "/export" else DEADLINE_S


def is_timed(path: str) -> bool:
    """Clips may take long over a slow line; everything else must be quick."""
    return not path.startswith(("/media/", "/app/"))


def caller_name(scope: Scope) -> str:
    """Returns what the rate limit counts by: the token, else the address; neither is kept."""
    for name, value in scope["headers"]:
        if name == b"authorization":
            return hashlib.sha256(value).hexdigest()
    client = scope.get("client")
    return client[0] if client else ""


async def read_body(scope: Scope, receive: Receive) -> bytes:
    """Returns the whole body. Raises ApiError 413 as soon as it is known to be too large."""
    too_large = ApiError(
        413, "too_large", f"a body may have {MAX_BODY_BYTES} bytes", "send less at once"
    )
    for name, value in scope["headers"]:
        if name == b"content-length" and (not value.isdigit() or int(value) > MAX_BODY_BYTES):
            raise too_large
    chunks: list[bytes] = []
    size = 0
    while True:
        message = await receive()
        if message["type"] != "http.request":
            return b"".join(chunks)
        chunk = message.get("body", b"")
        size += len(chunk)
        if size > MAX_BODY_BYTES:
            raise too_large
        chunks.append(chunk)
        if not message.get("more_body", False):
            return b"".join(chunks)


def replay(body: bytes, receive: Receive) -> Receive:
    """Returns a receive that hands out the body that was read, then what the client does next."""
    handed_out = False

    async def receive_again() -> Message:
        nonlocal handed_out
        if not handed_out:
            handed_out = True
            return {"type": "http.request", "body": body, "more_body": False}
        message: dict[str, Any] = dict(await receive())
        return message

    return receive_again
