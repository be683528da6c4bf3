# SPDX-License-Identifier: MIT
"""Many participants in one thread: bare HTTP on sockets, so that what is timed is the server."""

from __future__ import annotations

import asyncio
import json
import threading
import time
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlsplit

from study_tools import trial_body

GIVE_UP_S = 15.0  # as the page does
AGAIN_S = 0.2


@dataclass
class Crowd:
    """Participants who answer at a steady pace, send again as the page does, and keep count.

    Whoever comes back to a reply late answers at once, so that the pace offered stays the same.
    """

    address: str
    tokens: list[str]
    pace_s: float
    acknowledged: set[str] = field(default_factory=set)
    latencies_s: dict[str, list[float]] = field(default_factory=lambda: {"GET": [], "POST": []})
    errors: list[str] = field(default_factory=list)
    _stop: threading.Event = field(default_factory=threading.Event)

    def start(self) -> None:
        self._thread = threading.Thread(target=lambda: asyncio.run(self._run_all()))
        self._thread.start()

    def join(self) -> None:
        self._stop.set()
        self._thread.join()

    async def _run_all(self) -> None:
        await asyncio.gather(*(self._run(token, i) for i, token in enumerate(self.tokens)))

    async def _run(self, token: str, number: int) -> None:
        line = Line(self.address, token)
        due = time.monotonic() + self.pace_s * number / len(self.tokens)
        while not self._stop.is_set():
            await asyncio.sleep(max(0.0, due - time.monotonic()))
            due += self.pace_s
            trial = await self._until_done(line, "GET", "/api/next", None)
            if trial is None or trial["trial"] is None:
                break
            body = trial_body(trial["trial"]["trial_id"])
            if await self._until_done(line, "POST", "/api/trials", body) is not None:
                self.acknowledged.add(body["submission_id"])
        line.hang_up()

    async def _until_done(self, line: Line, method: str, path: str, body: Any) -> Any:
        """Sends until it is answered; the same body again, as the page's outbox does."""
        while not self._stop.is_set():
            begun = time.perf_counter()
            try:
                status, reply = await asyncio.wait_for(line.ask(method, path, body), GIVE_UP_S)
            except (OSError, EOFError, TimeoutError):
                line.hang_up()
                await asyncio.sleep(AGAIN_S)
                continue
            if status < 300:
                self.latencies_s[method].append(time.perf_counter() - begun)
                return reply
            self.errors.append(f"{status} {path}")
            await asyncio.sleep(AGAIN_S)
        return None


class Line:
    """One participant's connection, kept open between requests."""

    def __init__(self, address: str, token: str) -> None:
        parts = urlsplit(address)
        self._host, self._port, self._token = parts.hostname, parts.port, token
        self._streams: tuple[asyncio.StreamReader, asyncio.StreamWriter] | None = None

    async def ask(self, method: str, path: str, body: Any) -> tuple[int, Any]:
        """Returns status and reply. Raises OSError or EOFError where the server goes away."""
        if self._streams is None:
            self._streams = await asyncio.open_connection(self._host, self._port)
        reader, writer = self._streams
        content = b"" if body is None else json.dumps(body).encode()
        writer.write(
            f"{method} {path} HTTP/1.1\r\nhost: {self._host}\r\n"
            f"authorization: Bearer {self._token}\r\ncontent-type: application/json\r\n"
            f"content-length: {len(content)}\r\n\r\n".encode()
            + content
        )
        head = (await reader.readuntil(b"\r\n\r\n")).decode().lower()
        length = int(head.split("content-length:")[1].split("\r\n")[0])
        return int(head.split()[1]), json.loads(await reader.readexactly(length))

    def hang_up(self) -> None:
        if self._streams is not None:
            self._streams[1].close()
            self._streams = None
