# SPDX-License-Identifier: MIT
"""Lab mode for real: `verisim study serve --kiosk` on a screen of its own, and two participants.

Run on request: `python -m pytest tests/stress/study_kiosk_stress.py -s`. Needs Xvfb.
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Error, Page, sync_playwright

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "study" / "browser"))

from mini_clips import write_set  # noqa: E402
from page_participant import Participant  # noqa: E402
from study_site import STUDY, StudyServer  # noqa: E402

SCREEN = (1280, 720)
pytestmark = pytest.mark.timeout(300)


def free_port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


@pytest.fixture
def display(tmp_path: Path) -> Iterator[str]:
    """A screen in memory."""
    reads, writes = os.pipe()
    size = f"{SCREEN[0]}x{SCREEN[1]}x24"
    command = ["Xvfb", "-displayfd", str(writes), "-screen", "0", size, "-nolisten", "tcp"]
    with (tmp_path / "xvfb.log").open("w") as log:
        xvfb = subprocess.Popen(command, pass_fds=[writes], stdout=log, stderr=log)
    os.close(writes)
    with os.fdopen(reads) as told:
        number = told.readline().strip()
    yield f":{number}"
    xvfb.terminate()
    xvfb.wait()


def browser_on(folder: Path, debug_port: int) -> Path:
    """A `chromium` that can be looked into; the superuser's needs a flag more.

    Nothing manages windows on this screen, so that nothing would enlarge the browser's.
    """
    folder.mkdir()
    wrapper = folder / "chromium"
    flags = f"--remote-debugging-port={debug_port} --window-size={SCREEN[0]},{SCREEN[1]}"
    if os.getuid() == 0:
        flags += " --no-sandbox"
    wrapper.write_text(f'#!/bin/sh\nexec /usr/bin/chromium {flags} "$@"\n')
    wrapper.chmod(0o755)
    return folder


def take_part(page: Page) -> None:
    page.set_default_timeout(20_000)
    Participant(page).go_through()


def test_the_kiosk_fills_the_screen_and_serves_one_participant_after_the_other(
    display: str, tmp_path: Path
) -> None:
    rows = [{"stimulus": f"clip_{i}", "scene": "s", "role": "test"} for i in range(2)]
    site = StudyServer(tmp_path, write_set(tmp_path / "clips", "mini", rows), STUDY)
    debug_port = free_port()
    path = f"{browser_on(tmp_path / 'bin', debug_port)}:{os.environ['PATH']}"
    command = [sys.executable, "-m", "verisim", "study", "serve", str(site.study)]
    command += ["--clips", str(site.clips), "--db", str(site.db), "--port", str(site.port)]
    with (tmp_path / "serve.log").open("w") as log:
        serving = subprocess.Popen(
            [*command, "--kiosk"],
            env={**os.environ, "DISPLAY": display, "PATH": path},
            stdout=log,
            stderr=log,
            start_new_session=True,
        )
    try:
        with sync_playwright() as playwright:
            for _ in range(120):
                try:
                    at = f"http://127.0.0.1:{debug_port}"
                    browser = playwright.chromium.connect_over_cdp(at)
                    break
                except Error:
                    assert serving.poll() is None, (tmp_path / "serve.log").read_text()
                    time.sleep(1)
            else:
                raise AssertionError("no browser came within two minutes")
            [page] = browser.contexts[0].pages
            page.get_by_role("button", name="I agree").wait_for()
            assert page.url.startswith(site.address)
            shown = page.evaluate("[window.innerWidth, window.innerHeight]")
            # No bars, no frame. 1279 x 719 measured: without a window manager one pixel stays away.
            assert all(abs(got - full) <= 2 for got, full in zip(shown, SCREEN, strict=True))
            take_part(page)
            page.keyboard.press("n")
            page.get_by_role("button", name="I agree").wait_for()
            take_part(page)
            browser.close()
    finally:
        os.killpg(serving.pid, signal.SIGINT)
        serving.wait(30)
    people = site.rows("SELECT state FROM participant")
    print(f"\nkiosk: {len(people)} participants, window {shown}")
    assert people == [{"state": "completed"}] * 2
