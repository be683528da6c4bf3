# SPDX-License-Identifier: MIT
"""Short clips, a real server with its database, and a real browser."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from mini_clips import write_set
from playwright.sync_api import Browser, sync_playwright
from study_site import STUDY, WEB, StudyServer, Visit

QUIET = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


@pytest.fixture(scope="session")
def page_build() -> Path:
    """The page, built from its sources as they are now."""
    assert (WEB / "node_modules").is_dir(), "run `npm ci` in study/web first"
    subprocess.run(["npm", "run", "-s", "build"], cwd=WEB, check=True, capture_output=True)
    return WEB


@pytest.fixture(scope="session")
def clips(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A stimulus directory: one practice clip, three test clips, one catch clip; 0.3 s, 320x180."""
    roles = ["practice", "test", "test", "test", "catch"]
    rows = [
        {
            "stimulus": f"clip_{i}",
            "scene": "scene",
            "role": role,
            "reference": "clip_3" if i in (1, 2) else "",
        }
        for i, role in enumerate(roles)
    ]
    return write_set(tmp_path_factory.mktemp("clips"), "mini", rows)


@pytest.fixture
def study_server(
    request: pytest.FixtureRequest, tmp_path: Path, clips: Path, page_build: Path
) -> Iterator[StudyServer]:
    """The mini study; a test can name another, by its text or with settings."""
    del page_build
    wanted = getattr(request, "param", STUDY)
    study, settings = wanted if isinstance(wanted, tuple) else (wanted, {})
    server = StudyServer(tmp_path, clips, study, **settings)
    server.start()
    yield server
    server.kill()


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=QUIET)
        yield chromium
        chromium.close()


@pytest.fixture
def visit(browser: Browser, study_server: StudyServer) -> Iterator[Visit]:
    """A fresh profile at 1280x720."""
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    yield Visit(context, study_server)
    context.close()
