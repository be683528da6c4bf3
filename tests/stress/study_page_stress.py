# SPDX-License-Identifier: MIT
"""Long runs of the study page: fifty visits in a row, one long visit, the examples in full length.

Run on request: `python -m pytest tests/stress/study_page_stress.py -s`. Prints what it measured.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "study" / "browser"))

from mini_clips import write_example_set, write_set  # noqa: E402
from page_participant import Participant  # noqa: E402
from study_site import SIMULATED, STUDY, StudyServer, Visit  # noqa: E402

NUM_VISITS = 50
NUM_TRIALS = 60
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


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_browser_completes_each_example_study_in_full_length(
    browser: Browser, tmp_path: Path, name: str
) -> None:
    studies = ROOT / "study" / "studies"
    text = (studies / f"{name}.yaml").read_text().replace("texts/", f"{studies}/texts/")
    set_file = ROOT / "stimuli" / "sets" / f"{EXAMPLES[name]}.yaml"
    server = StudyServer(tmp_path, write_example_set(tmp_path / "clips", set_file), text)
    server.start()
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    visit = Visit(context, server)
    one = visit.open()
    one.go_through()
    trials = server.rows("SELECT answered_utc FROM trial")
    print(f"\n{name}: {len(trials)} trials")
    assert all(trial["answered_utc"] for trial in trials)
    assert server.rows("SELECT state FROM participant") == [{"state": "completed"}]
    assert visit.complaints == []
    context.close()
    server.kill()
