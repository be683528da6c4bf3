# SPDX-License-Identifier: MIT
"""Long runs of the study page: fifty visits in a row, one long visit, the examples in full length.

Run on request: `python -m pytest tests/stress/study_page_stress.py -s`. Prints what it measured.
"""

from __future__ import annotations

import re
import sqlite3
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "study" / "browser"))

from mini_clips import write_set  # noqa: E402
from page_participant import Participant  # noqa: E402
from study_site import SIMULATED, STUDY, StudyServer, Visit  # noqa: E402

NUM_VISITS = 50
NUM_TRIALS = 60
NUM_RATERS = 24
PREVIEW = "320x180"
EXAMPLES = {
    "seed_questions": "demo",
    "realism_ratings": "demo",
    "collision_thresholds": "collision_tracks",
    "which_is_real": "real_pairs",
}

pytestmark = pytest.mark.timeout(3600)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(
            executable_path="/usr/bin/chromium", args=["--no-sandbox", "--disable-gpu"]
        )
        yield chromium
        chromium.close()


def clips(directory: Path, num_tests: int) -> Path:
    roles = ["practice", *["test"] * num_tests]
    rows = [{"stimulus": f"clip_{i}", "scene": "s", "role": role} for i, role in enumerate(roles)]
    return write_set(directory, "mini", rows)


def server_memory_mib(server: StudyServer) -> float:
    assert server.process is not None
    status = Path(f"/proc/{server.process.pid}/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0]) / 1024


def page_weight(page: Page) -> dict[str, float]:
    """What the page holds after a garbage collection."""
    tools = page.context.new_cdp_session(page)
    tools.send("HeapProfiler.enable")
    tools.send("HeapProfiler.collectGarbage")
    tools.send("Performance.enable")
    metrics = {it["name"]: it["value"] for it in tools.send("Performance.getMetrics")["metrics"]}
    tools.detach()
    return {
        "heap_mib": metrics["JSHeapUsedSize"] / 2**20,
        "nodes": metrics["Nodes"],
        "listeners": metrics["JSEventListeners"],
        "videos": page.locator("video").count(),
    }


def test_fifty_visits_in_a_row_leave_nothing_behind(browser: Browser, tmp_path: Path) -> None:
    server = StudyServer(tmp_path, clips(tmp_path / "clips", 4))
    server.start()
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    visit = Visit(context, server)
    page = context.new_page()
    page.set_default_timeout(20_000)
    weights, memory_mib = [], []
    for _ in range(NUM_VISITS):
        page.goto(server.address + "/" + SIMULATED)
        one = Participant(page)
        one.go_through()
        assert one.num_undelivered() == 0
        weights.append(page_weight(page))
        memory_mib.append(server_memory_mib(server))
        page.evaluate("localStorage.clear()")  # the next participant sits down
    print(f"\npage: first {weights[0]}, fifth {weights[4]}, last {weights[-1]}")
    print(f"server: fifth {memory_mib[4]:.1f} MiB, last {memory_mib[-1]:.1f} MiB")
    states = server.rows("SELECT state, count(*) num FROM participant GROUP BY state")
    assert states == [{"state": "completed", "num": NUM_VISITS}]
    [answers] = server.rows("SELECT count(*) num FROM response")
    assert answers["num"] == NUM_VISITS * 5 * 3  # five trials with three numeric questions
    assert visit.complaints == []
    assert weights[-1]["heap_mib"] < 1.2 * weights[4]["heap_mib"]
    assert weights[-1]["nodes"] < 1.2 * weights[4]["nodes"]
    assert memory_mib[-1] < memory_mib[4] + 30
    context.close()
    server.kill()


def test_a_long_visit_does_not_grow_with_its_trials(browser: Browser, tmp_path: Path) -> None:
    server = StudyServer(tmp_path, clips(tmp_path / "clips", NUM_TRIALS), STUDY)
    server.start()
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    page = context.new_page()
    page.set_default_timeout(20_000)
    page.goto(server.address + "/" + SIMULATED)
    one = Participant(page)
    weights: list[dict[str, float]] = []

    def answer(i: int) -> None:
        weights.append(page_weight(page))
        one.answer_anything(i % 2)

    one.come_to_first_clip()
    one.finish(answer=answer)
    print(f"\npage: tenth trial {weights[9]}, last trial {weights[-1]}")
    assert weights[-1]["nodes"] < 1.2 * weights[9]["nodes"]
    assert weights[-1]["listeners"] < 1.2 * weights[9]["listeners"]
    assert weights[-1]["heap_mib"] < weights[9]["heap_mib"] + 2
    assert weights[-1]["videos"] == 0
    context.close()
    server.kill()


@pytest.fixture(scope="module")
def built_sets(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sets of the examples as `verisim stimuli build` makes them, at the size of a preview."""
    folder = tmp_path_factory.mktemp("built")
    (folder / "sets").mkdir()
    for shared in ("scenes", "meshes"):
        (folder / shared).symlink_to(ROOT / "stimuli" / shared)
    for name in sorted(set(EXAMPLES.values())):
        text = (ROOT / "stimuli" / "sets" / f"{name}.yaml").read_text()
        small = re.sub(r"(?m)^size: .*$", f"size: {PREVIEW}", text)
        assert small != text
        set_file = folder / "sets" / f"{name}.yaml"
        set_file.write_text(small)
        verisim("stimuli", "build", set_file, "-o", folder / name)
    return folder


def verisim(*words: object) -> None:
    command = [sys.executable, "-m", "verisim", *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_rater_in_a_browser_completes_each_example_study_in_full_length(
    built_sets: Path, tmp_path: Path, name: str
) -> None:
    study, db = ROOT / "study" / "studies" / f"{name}.yaml", tmp_path / "visits.db"
    begun = time.monotonic()
    visit = ("--clips", built_sets / EXAMPLES[name], "--participants", 1, "--db", db, "--browser")
    verisim("study", "simulate", study, *visit)
    took_s = time.monotonic() - begun
    with sqlite3.connect(db) as connection:
        [(num_trials, num_open)] = connection.execute(
            "SELECT count(*), sum(answered_utc IS NULL) FROM trial"
        )
        [shown] = connection.execute(
            "SELECT sum(frames_total), sum(frames_dropped), sum(stall_count) FROM presentation"
        )
        states = connection.execute("SELECT state, source FROM participant").fetchall()
    print(f"\n{name}: {num_trials} trials, {took_s:.0f} s; frames, dropped, stalls: {shown}")
    assert num_open == 0
    assert states == [("completed", "simulated")]


@pytest.mark.parametrize("name", EXAMPLES)
def test_scripted_raters_complete_each_example_study_and_it_is_analysed(
    built_sets: Path, tmp_path: Path, name: str
) -> None:
    study = ROOT / "study" / "studies" / f"{name}.yaml"
    clips, db = built_sets / EXAMPLES[name], tmp_path / "raters.db"
    begun = time.monotonic()
    rater = ("--participants", NUM_RATERS, "--db", db)
    verisim("study", "simulate", study, "--clips", clips, *rater)
    took_s = time.monotonic() - begun
    verisim("export", "--db", db, "-o", tmp_path / "export")
    verisim("analyse", tmp_path / "export", "-o", tmp_path / "report", "--source", "simulated")
    with sqlite3.connect(db) as connection:
        states = connection.execute(
            "SELECT state, source, count(*) FROM participant GROUP BY state, source"
        ).fetchall()
        [(num_answers,)] = connection.execute("SELECT count(*) FROM response")
        [(num_open,)] = connection.execute("SELECT count(*) FROM trial WHERE answered_utc IS NULL")
    print(f"\n{name}: {NUM_RATERS} raters, {num_answers} answers in {took_s:.0f} s")
    assert states == [("completed", "simulated", NUM_RATERS)]
    assert num_open == 0
    report = (tmp_path / "report" / "report.html").read_text()
    assert f"<h1>{name}" in report and "Scripted raters, not people" in report
