# SPDX-License-Identifier: MIT
"""`study simulate --browser`: broken runs go on, and a page that complains is no success."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from browser_runs import Run, in_order, in_own_thread, run_raters
from mini_clips import write_set
from study_site import STUDY, TEXTS

from verisim.study.problems import StudyError
from verisim.study.server import simulate_in_browser

FORMS_EACH = 2  # one practice clip, one test clip


def write_mini(folder: Path, **texts: str) -> Path:
    for name, text in (TEXTS | {f"{name}.md": text for name, text in texts.items()}).items():
        (folder / name).write_text(text)
    study = folder / "mini.yaml"
    study.write_text(STUDY)
    return study


@pytest.fixture(scope="module")
def clips(tmp_path_factory: pytest.TempPathFactory) -> Path:
    rows = [{"stimulus": role, "scene": "s", "role": role} for role in ("practice", "test")]
    return write_set(tmp_path_factory.mktemp("two"), "mini", rows)


def test_a_broken_run_goes_on_with_the_raters_that_are_missing(
    tmp_path: Path, clips: Path, page_build: Path
) -> None:
    del page_build
    run = Run(write_mini(tmp_path), clips, tmp_path / "study.db")

    def break_off(done: int, _total: int) -> None:
        if done == FORMS_EACH + 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        in_own_thread(
            lambda: simulate_in_browser(run.study, run.clips, run.db, 2, 5, on_progress=break_off)
        )
    states = "SELECT state, count(*) FROM participant GROUP BY state ORDER BY state"
    assert run.rows(states) == [("active", 1), ("completed", 1)]

    run_raters(run, 2)
    assert [visit.rater for visit in run.visits] == [1]
    assert run.progress[-1] == (2 * FORMS_EACH, 2 * FORMS_EACH)
    assert run.rows(states) == [("active", 1), ("completed", 2)]
    assert run.rows("SELECT DISTINCT source FROM participant") == [("simulated",)]
    last = "(SELECT max(trial_id) - 2 FROM trial)"
    given = in_order((key, item, value, text) for key, item, value, text in run.judged)
    assert run.stored(f"trial_id > {last}") == given

    # The command, asked for raters that are there already, sends nobody.
    words = ["study", "simulate", run.study, "--clips", clips, "--db", run.db]
    words += ["--participants", 2, "--seed", 5, "--browser"]
    command = [sys.executable, "-m", "verisim", *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "rater" not in done.stderr and run.rows(states) == [("active", 1), ("completed", 2)]


def test_a_page_that_asks_elsewhere_is_no_success(
    tmp_path: Path, clips: Path, page_build: Path
) -> None:
    del page_build
    picture = "# {title}\n\n![logo](https://example.org/logo.png)\n\nVersion: 1\n"
    study = write_mini(tmp_path, consent=picture)
    run = Run(study, clips, tmp_path / "study.db")
    with pytest.raises(StudyError, match=r"the page complained to rater 0: .*example.org"):
        run_raters(run, 1)


def test_without_playwright_the_command_says_what_to_install(
    tmp_path: Path, clips: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "playwright.sync_api", None)
    with pytest.raises(StudyError, match=r"pip install 'verisim\[browser\]'"):
        simulate_in_browser(write_mini(tmp_path), clips, tmp_path / "study.db", 1, 5)
