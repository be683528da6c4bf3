# SPDX-License-Identifier: MIT
"""The example studies run from their files to their last page, here with fewer, shorter trials."""

from __future__ import annotations

from pathlib import Path

import pytest
from mini_clips import write_example_set
from playwright.sync_api import Browser
from study_site import SIMULATED, StudyServer, Visit

ROOT = Path(__file__).resolve().parents[3]
# Where each study is shortened; its full length runs in tests/stress.
SHORTER = {
    "realism_ratings": {
        "fixation_ms: [500, 1500]": "fixation_ms: [50, 60]",
        "scenes: [bounce_ball, fox_tumble]": "scenes: [fox_tumble]",
        "scenes: [ball_hits_box, box_stack]": "scenes: [box_stack]",
        "rest_min_s: 5": "rest_min_s: 0",
    },
    "collision_thresholds": {
        "fixation_ms: [500, 1000]": "fixation_ms: [50, 60]",
        "rest_min_s: 5": "rest_min_s: 0",
        "trials: 12}": "trials: 1}",
        "undistorted: 8": "undistorted: 1",
        "    - {sampler: constant_stimuli, factor: gravity, times: 2}\n": "",
    },
    "which_is_real": {
        "fixation_ms: [500, 1000]": "fixation_ms: [50, 60]",
        "gap_ms: 500": "gap_ms: 50",
        "times: 2": "times: 1",
        "rest_min_s: 5": "rest_min_s: 0",
    },
}
SETS = {"collision_thresholds": "collision_tracks", "which_is_real": "real_pairs"}


def shortened(name: str) -> str:
    text = (ROOT / "study" / "studies" / f"{name}.yaml").read_text()
    for long, short in SHORTER[name].items():
        assert long in text, f"{name}.yaml no longer says {long!r}"
        text = text.replace(long, short)
    return text.replace("texts/", f"{ROOT}/study/studies/texts/")


@pytest.mark.parametrize("name", sorted(SHORTER))
def test_a_browser_completes_each_example_study(
    browser: Browser, tmp_path: Path, page_build: Path, name: str
) -> None:
    del page_build
    set_file = ROOT / "stimuli" / "sets" / f"{SETS.get(name, 'demo')}.yaml"
    clips = write_example_set(tmp_path / "clips", set_file)
    server = StudyServer(tmp_path, clips, shortened(name))
    server.start()
    try:
        context = browser.new_context(viewport={"width": 1280, "height": 720})
        visit = Visit(context, server)
        one = visit.open(SIMULATED)
        num_forms = one.go_through()
        context.close()
        trials = server.rows("SELECT answered_utc, layout FROM trial")
        assert all(trial["answered_utc"] for trial in trials)
        num_ends = 1 if server.rows("SELECT * FROM session_answer") else 0
        assert num_forms == len(trials) + num_ends
        shown = server.rows("SELECT completed FROM presentation")
        assert shown == [{"completed": 1}] * len(trials)
        assert [row["state"] for row in server.rows("SELECT state FROM participant")] == [
            "completed"
        ]
        assert visit.complaints == []
    finally:
        server.kill()
