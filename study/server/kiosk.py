# SPDX-License-Identifier: MIT
"""Lab mode: a full-screen browser on this machine that shows the study page and nothing else."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
import threading
from pathlib import Path

from verisim.study.problems import refuse

BROWSERS = ("chromium", "chromium-browser", "google-chrome-stable", "google-chrome")
# A profile of its own that is deleted afterwards; nothing that talks to other servers, asks
# questions, translates, sleeps, or slows a page down that is thought to be in the background.
FLAGS = (
    "--kiosk",
    "--no-first-run",
    "--no-default-browser-check",
    "--disable-translate",
    "--disable-features=Translate,MediaRouter,OptimizationHints",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-extensions",
    "--disable-pinch",
    "--disable-session-crashed-bubble",
    "--disable-background-timer-throttling",
    "--disable-renderer-backgrounding",
    "--overscroll-history-navigation=0",
    "--autoplay-policy=no-user-gesture-required",
    "--password-store=basic",
)


def find_browser() -> str:
    """Returns the path of a Chromium. Raises StudyError where there is none."""
    for name in BROWSERS:
        if path := shutil.which(name):
            return path
    raise refuse("browser", "no Chromium is installed", "apt-get install chromium")


def kiosk_command(browser: str, address: str, profile: Path) -> list[str]:
    return [browser, *FLAGS, f"--user-data-dir={profile}", address]


def open_kiosk(address: str) -> threading.Thread:
    """Starts the browser beside the server; alt+F4 ends it, the server goes on until Ctrl-C."""
    browser = find_browser()

    def run() -> None:
        with tempfile.TemporaryDirectory(prefix="verisim-kiosk-") as profile:
            command = kiosk_command(browser, address, Path(profile))
            subprocess.run(command, check=False, capture_output=True)

    thread = threading.Thread(target=run, name="kiosk", daemon=True)
    thread.start()
    return thread
