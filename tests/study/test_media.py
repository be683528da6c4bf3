# SPDX-License-Identifier: MIT
"""Clips and page files: whole and in ranges, cached by content, and nothing else can be reached."""

from __future__ import annotations

import hashlib
import http.client
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import pytest
from anyio.from_thread import start_blocking_portal
from fastapi import FastAPI
from study_tools import Person, Server

from verisim.study.server.app import add_error_forms
from verisim.study.server.pages import add_pages


@pytest.fixture(scope="module")
def clip(server: Server) -> tuple[str, bytes]:
    """A clip's address and bytes."""
    described = Person.ready(server).trial()["clips"][0]
    path = next(
        path
        for path in (server.set_dir / "clips").glob("*.mp4")
        if hashlib.sha256(path.read_bytes()).hexdigest() == described["sha256"]
    )
    assert described["num_bytes"] == path.stat().st_size
    return described["url"], path.read_bytes()


def test_a_clip_comes_whole_and_may_be_kept_for_ever(
    server: Server, clip: tuple[str, bytes]
) -> None:
    url, content = clip
    with server.client() as client:
        reply = client.get(url)
        assert reply.status_code == 200 and reply.content == content
        assert reply.headers["content-type"] == "video/mp4"
        assert reply.headers["cache-control"] == "public, max-age=31536000, immutable"
        assert reply.headers["accept-ranges"] == "bytes"
        again = client.get(url, headers={"if-none-match": reply.headers["etag"]})
        assert again.status_code == 304 and again.content == b""
        head = client.head(url)
        assert head.status_code == 200 and head.content == b""
        assert int(head.headers["content-length"]) == len(content)


def test_ranges_of_a_clip(server: Server, clip: tuple[str, bytes]) -> None:
    url, content = clip
    n = len(content)
    with server.client() as client:
        for asked, start, end in (
            ("bytes=0-0", 0, 1),
            ("bytes=100-199", 100, 200),
            (f"bytes={n - 1}-", n - 1, n),
            ("bytes=-10", n - 10, n),
            (f"bytes=5-{n + 1000}", 5, n),
        ):
            reply = client.get(url, headers={"range": asked})
            assert reply.status_code == 206, asked
            assert reply.content == content[start:end], asked
            assert reply.headers["content-range"] == f"bytes {start}-{end - 1}/{n}"
        beyond = client.get(url, headers={"range": f"bytes={n}-"})
        assert beyond.status_code == 416 and beyond.headers["content-range"] == f"bytes */{n}"
        several = client.get(url, headers={"range": "bytes=0-1,5-6"})
        assert several.status_code == 206
        assert several.headers["content-type"].startswith("multipart/byteranges")
        etag = client.get(url).headers["etag"]
        part = {"range": "bytes=0-1"}
        assert client.get(url, headers={**part, "if-range": etag}).status_code == 206
        assert client.get(url, headers={**part, "if-range": '"other"'}).content == content


PROBES = (
    "/media/../manifest.csv",
    "/media/%2e%2e/manifest.csv",
    "/media/..%2fmanifest.csv",
    "/media/..%252fmanifest.csv",
    "/media/manifest.csv",
    "/media//etc/passwd",
    "/media/" + "0" * 64 + ".mp4",
    "/media/clips/x.mp4",
    "/media/%00.mp4",
    "/app/../server/app.py",
    "/app/%2e%2e/%2e%2e/server/app.py",
    "/app/..%2f..%2fserver%2fapp.py",
    "/app//etc/passwd",
    "/app/%2fetc%2fpasswd",
    "/app/%00",
    "/app/",
    "/app/..",
)


@pytest.mark.parametrize("path", PROBES)
def test_nothing_outside_the_page_and_the_clips_can_be_read(server: Server, path: str) -> None:
    address = urlsplit(server.address)
    connection = http.client.HTTPConnection(address.hostname or "", address.port, timeout=10)
    connection.request("GET", path)  # sent as it is, not normalised
    reply = connection.getresponse()
    body = reply.read()
    connection.close()
    assert reply.status == 404, body
    assert b"root:" not in body and b"SPDX" not in body


def test_a_mistyped_address_is_answered_in_words(server: Server) -> None:
    with server.client() as client:
        reply = client.get("/studdy", headers={"accept": "text/html,*/*"})
    assert reply.status_code == 404 and "open the link that you were given" in reply.text


def get_page(dist: Path, path: str) -> httpx.Response:
    """Asks the routes of the page directly, with a folder of our own as the built page."""
    app = FastAPI()
    add_error_forms(app)
    add_pages(app, {}, dist)

    async def ask() -> httpx.Response:
        transport = httpx.ASGITransport(app)
        async with httpx.AsyncClient(transport=transport, base_url="http://study") as client:
            return await client.get(path)

    with start_blocking_portal() as portal:  # the browser leaves a loop running
        return portal.call(ask)


def test_the_page_and_its_assets_are_served(tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text("<p>hello</p>")
    (tmp_path / "app.js").write_text("export {}")
    assert get_page(tmp_path, "/").text == "<p>hello</p>"
    script = get_page(tmp_path, "/app/app.js?v=1")
    assert script.text == "export {}" and "javascript" in script.headers["content-type"]


def test_a_page_that_was_not_built_says_what_to_run(tmp_path: Path) -> None:
    reply = get_page(tmp_path / "missing", "/")
    assert reply.status_code == 503 and "npm run build" in reply.text
