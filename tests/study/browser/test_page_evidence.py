# SPDX-License-Identifier: MIT
"""What the screen did is recorded: lost frames, stalls, time out of sight, lost focus, size."""

from __future__ import annotations

import json

import pytest
from mini_clips import NUM_FRAMES
from playwright.sync_api import Browser
from study_site import StudyServer, Visit

# Eight times too fast: the screen can show one frame in eight.
TOO_FAST = "document.addEventListener('play', (event) => { event.target.playbackRate = 8; }, true)"
# What a browser reports when the clip stalls for 60 ms, the page is covered for 80 ms, and another
# window takes the keyboard.
TROUBLED = """
const after = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const cover = (is_hidden) => {
    Object.defineProperty(document, 'hidden', {value: is_hidden, configurable: true});
    document.dispatchEvent(new Event('visibilitychange'));
};
document.addEventListener('play', async ({target}) => {
    await after(60);
    target.dispatchEvent(new Event('waiting'));
    window.dispatchEvent(new Event('blur'));
    await after(60);
    target.dispatchEvent(new Event('playing'));
    cover(true);
    await after(80);
    cover(false);
}, true);
"""


@pytest.mark.parametrize("trouble", ["lost frames", "interrupted"])
def test_trouble_while_a_clip_plays_is_recorded(
    browser: Browser, study_server: StudyServer, trouble: str
) -> None:
    context = browser.new_context(viewport={"width": 700, "height": 400})
    context.add_init_script(TOO_FAST if trouble == "lost frames" else TROUBLED)
    one = Visit(context, study_server).open()
    one.come_to_questions()
    one.answer(0)
    one.submit()
    one.wait_for_heading("Practice is over")
    [shown] = study_server.rows("SELECT * FROM presentation")
    assert (shown["displayed_w_px"], shown["displayed_h_px"], shown["scale"]) == (640, 360, 2)
    assert (shown["device_pixel_ratio"], shown["fullscreen"], shown["num_plays"]) == (1, 0, 1)
    if trouble == "lost frames":
        assert shown["frames_dropped"] >= NUM_FRAMES // 2  # measured 14 to 15 of 18
        assert (shown["hidden_ms"], shown["blur_count"]) == (0, 0)
    else:
        assert (shown["stall_count"], shown["blur_count"]) == (1, 1)
        # Timers come late on a busy machine, never early.
        assert 55 <= shown["stall_ms"] < 5_000
        assert 75 <= shown["hidden_ms"] < 5_000
        kinds = [row["kind"] for row in study_server.rows("SELECT kind FROM event")]
        assert {"stall", "hidden", "blur", "play_ended"} <= set(kinds)
    [end] = study_server.rows("SELECT detail_json FROM event WHERE kind = 'play_ended'")
    assert json.loads(end["detail_json"])["frames_dropped"] == shown["frames_dropped"]
    [clip] = study_server.rows(
        "SELECT c.*, s.sha256 FROM presentation_clip c JOIN stimulus s USING (stimulus_id)"
    )
    [trial] = study_server.rows(
        "SELECT stimulus_a FROM trial t JOIN presentation p USING (trial_id)"
    )
    assert clip["stimulus_id"] == trial["stimulus_a"]
    assert (clip["onset_ms"], clip["ended_ms"]) == (shown["onset_ms"], shown["ended_ms"])
    context.close()
