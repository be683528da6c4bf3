# SPDX-License-Identifier: MIT
"""Scripted raters take the study through the real HTTP interface of a real server."""

from __future__ import annotations

import hashlib
import random
import secrets
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from verisim.study.problems import refuse
from verisim.study.server.http_client import HttpClient
from verisim.study.server.observer import Observer, visible_error
from verisim.study.server.questions import Question
from verisim.study.server.run_server import serving_in_background
from verisim.study.server.stimulus_set import load_stimulus_set
from verisim.study.server.study_file import load_study

AT_ONCE = 4  # raters in parallel
ENVIRONMENT = {
    "browser": "scripted rater",
    "browser_version": "1",
    "os": "none",
    "is_mobile": False,
    "screen_w": 1280,
    "screen_h": 720,
    "viewport_w": 1280,
    "viewport_h": 720,
    "device_pixel_ratio": 1,
    "refresh_hz": None,
    "language": "en",
    "tz_offset_min": 0,
    "app_version": "scripted rater",
}

OnProgress = Callable[[int, int], None]


@dataclass
class Clips:
    """What raters see of the clips: the visible error by sha256; each clip is fetched once."""

    errors: dict[str, float]
    fetched: set[str] = field(default_factory=set)
    lock: threading.Lock = field(default_factory=threading.Lock)

    def watch(self, client: HttpClient, clip: dict[str, Any]) -> float:
        """Fetches a clip as the page would, checks its bytes, and returns its visible error."""
        with self.lock:
            is_new = clip["sha256"] not in self.fetched
            self.fetched.add(clip["sha256"])
        if is_new:
            seen = hashlib.sha256(client.get_bytes(clip["url"])).hexdigest()
            if seen != clip["sha256"]:
                raise refuse(clip["url"], f"the server sent other bytes (sha256 {seen[:12]}…)")
        return self.errors[clip["sha256"]]


def simulate(
    study: Path,
    set_dir: Path,
    db: Path,
    participants: int,
    seed: int,
    port: int = 0,
    *,
    on_progress: OnProgress = lambda _done, _total: None,
) -> None:
    """Lets scripted raters take the whole study; their data carry source `simulated`.

    Answers follow from each clip's visible error and the rater's stated traits (observer.py), which
    are stored as an `observer` event of the session. The same seed in a new database gives the same
    raters, orders and answers. Raises StudyError where serving would, and when a rater is refused.
    """
    if participants < 1:
        raise refuse("participants", f"{participants} is not allowed", "give a number from 1")
    loaded = load_study(study)
    clips = Clips({s.sha256: visible_error(s) for s in load_stimulus_set(set_dir).stimuli})
    questions = {question.key: question for question in loaded.questions}
    key = secrets.token_urlsafe(32)
    done = 0
    lock = threading.Lock()
    with serving_in_background(study, set_dir, db, port, simulate_key=key) as address:
        raters = [
            Rater(address, random.Random(f"{seed}:{i}"), clips, questions)
            for i in range(participants)
        ]
        for rater in raters:  # one after another, so that rater i always gets the same order
            rater.enrol(key)

        def run(rater: Rater) -> None:
            nonlocal done
            rater.take_part()
            with lock:
                done += 1
                on_progress(done, participants)

        on_progress(0, participants)
        with ThreadPoolExecutor(AT_ONCE) as pool:
            list(pool.map(run, raters))


class Rater:
    """One scripted participant, from the first request to thanks."""

    def __init__(
        self, address: str, rng: random.Random, clips: Clips, questions: dict[str, Question]
    ) -> None:
        self._address = address
        self._rng = rng
        self._clips = clips
        self._questions = questions
        self._observer = Observer.draw(rng)
        self._clock_ms = 0.0
        self._token = ""

    def enrol(self, simulate_key: str) -> None:
        with HttpClient(self._address) as client:
            opened = client.post(
                "/api/sessions",
                source="simulated",
                simulate_key=simulate_key,
                environment=ENVIRONMENT,
            )
        self._token = opened["token"]

    def take_part(self) -> None:
        with HttpClient(self._address, self._token) as client:
            self._begin(client)
            while (step := client.get("/api/next"))["step"] == "trial":
                client.post("/api/trials", **self._answer(client, step["trial"]))
        if step["step"] != "thanks":
            raise refuse("simulate", f"a rater ended at {step['step']!r} instead of thanks")

    def _begin(self, client: HttpClient) -> None:
        """Stores the rater's traits, agrees to the consent form and reads the instructions."""
        event = {
            "seq": 0,
            "presentation_id": None,
            "kind": "observer",
            "t_ms": 0,
            "detail": self._observer.describe(),
        }
        client.post("/api/events", events=[event])
        page = client.get("/api/study")
        client.post(
            "/api/consent",
            agreed=True,
            form_version=page["consent"]["version"],
            form_sha256=page["consent"]["sha256"],
            language=page["language"],
        )
        client.post("/api/instructions")

    def _answer(self, client: HttpClient, trial: dict[str, Any]) -> dict[str, Any]:
        clip = trial["clips"][0]
        error = max(self._clips.watch(client, clip) for clip in trial["clips"])
        length_ms = 1000 * clip["duration_s"]
        onset_ms = self._clock_ms + 800
        self._clock_ms = onset_ms + length_ms + 4000
        responses = [self._respond(self._questions[key], error) for key in trial["question_keys"]]
        presentation = {
            "presentation_id": client.new_id(),
            "num_plays": 1,
            "onset_ms": onset_ms,
            "first_frame_ms": 0,
            "ended_ms": onset_ms + length_ms,
            "frames_total": clip["num_frames"],
            "frames_dropped": 0,
            "stall_count": 0,
            "stall_ms": 0,
            "hidden_ms": 0,
            "fullscreen": False,
            "displayed_w": clip["width_px"],
            "displayed_h": clip["height_px"],
            "completed": True,
        }
        return {
            "trial_id": trial["trial_id"],
            "presentation": presentation,
            "responses": responses,
        }

    def _respond(self, question: Question, error: float) -> dict[str, Any]:
        felt = self._observer.feel(error, self._rng)
        answer = question.simulate(felt, self._rng)
        rt_ms = round(1500 * self._rng.lognormvariate(0, 0.35), 1)
        return {
            "question": question.key,
            "value": answer.value,
            "value_text": answer.value_text,
            "rt_ms": rt_ms,
            "rt_origin": "video_end",
            "first_touch_ms": rt_ms,
            "num_changes": 0,
        }
