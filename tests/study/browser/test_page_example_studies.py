# SPDX-License-Identifier: MIT
"""The example studies run from their files to their last page, here with fewer, shorter trials."""

from __future__ import annotations

from pathlib import Path

import pytest
from browser_runs import Run, in_order, run_raters
from mini_clips import write_example_set

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
def test_a_rater_in_a_browser_completes_each_example_study(
    tmp_path: Path, page_build: Path, name: str
) -> None:
    del page_build
    study = tmp_path / f"{name}.yaml"
    study.write_text(shortened(name))
    clips = write_example_set(
        tmp_path / "clips", ROOT / "stimuli" / "sets" / f"{SETS.get(name, 'demo')}.yaml"
    )
    run = Run(study, clips, tmp_path / "study.db")
    run_raters(run, 1)
    trials = run.rows("SELECT answered_utc FROM trial")
    assert all(answered for (answered,) in trials)
    num_ends = 1 if run.rows("SELECT * FROM session_answer") else 0
    assert [visit.num_forms for visit in run.visits] == [len(trials) + num_ends]
    assert run.rows("SELECT completed FROM presentation") == [(1,)] * len(trials)
    assert run.rows("SELECT state, source FROM participant") == [("completed", "simulated")]
    # What the page sent is what the raters judged, question by question.
    assert run.stored() == in_order(run.judged)
