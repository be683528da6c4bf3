# SPDX-License-Identifier: MIT
"""Scripted raters: the whole study over HTTP in seconds, marked as simulated."""

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
from verisim.study.server.database import Place
from verisim.study.server.http_client import HttpClient
from verisim.study.server.judge import Answers, Judge, look_at_clips
from verisim.study.server.observer import Traits
from verisim.study.server.questions import Question
from verisim.study.server.run_server import serving_in_background
from verisim.study.server.study_file import load_study

AT_ONCE = 4  # raters in parallel
PX_PER_MM = 3.78  # of the scripted screen: 96 CSS px per inch
ENVIRONMENT = {
    "browser": "scripted rater",
    "browser_version": "1",
    "os": "none",
    "is_mobile": False,
    "screen_w": 3840,
    "screen_h": 2160,
    "viewport_w": 3840,
    "viewport_h": 2160,
    "device_pixel_ratio": 1,
    "refresh_hz": None,
    "language": "en",
    "tz_offset_min": 0,
    "app_version": "scripted rater",
}

OnProgress = Callable[[int, int], None]


@dataclass
class Fetched:
    """The clips that have been fetched by any rater: each is fetched and checked once."""

    clips: set[str] = field(default_factory=set)
    lock: threading.Lock = field(default_factory=threading.Lock)

    def fetch(self, client: HttpClient, clip: dict[str, Any]) -> None:
        """Fetches a clip as the page would and checks its bytes."""
        with self.lock:
            is_new = clip["sha256"] not in self.clips
            self.clips.add(clip["sha256"])
        if is_new:
            seen = hashlib.sha256(client.get_bytes(clip["url"])).hexdigest()
            if seen != clip["sha256"]:
                raise refuse(clip["url"], f"the server sent other bytes (sha256 {seen[:12]}…)")


def simulate(
    study: Path,
    set_dir: Path,
    db: Place,
    participants: int,
    seed: int,
    port: int = 0,
    *,
    traits: Traits | None = None,
    on_progress: OnProgress = lambda _done, _total: None,
) -> None:
    """Lets scripted raters take the whole study; their data carry source `simulated`.

    Answers follow from what each clip achieved and the rater's traits (observer.py), which are
    stored as an `observer` event of the session. The same seed in a new database gives the same
    raters, orders and answers. Raises StudyError where serving would, and when a rater is refused.
    """
    if participants < 1:
        raise refuse("participants", f"{participants} is not allowed", "give a number from 1")
    loaded = load_study(study)
    seen = look_at_clips(loaded, set_dir, traits)
    fetched = Fetched()
    key = secrets.token_urlsafe(32)
    done = 0
    lock = threading.Lock()
    with serving_in_background(study, set_dir, db, port, simulate_key=key) as address:
        raters = [
            Rater(address, rng, Judge(loaded, seen, rng, traits), fetched)
            for rng in (random.Random(f"{seed}:{i}") for i in range(participants))
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

    def __init__(self, address: str, rng: random.Random, judge: Judge, fetched: Fetched) -> None:
        self._address = address
        self._rng = rng
        self._judge = judge
        self._fetched = fetched
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
            while (step := client.get("/api/next"))["step"] in ("trial", "end_questions"):
                if step["step"] == "trial":
                    client.post("/api/trials", **self._answer(client, step["trial"]))
                else:
                    client.post("/api/end_questions", responses=self._answer_end())
        if step["step"] != "thanks":
            raise refuse("simulate", f"a rater ended at {step['step']!r} instead of thanks")

    def _begin(self, client: HttpClient) -> None:
        """Stores the rater's traits, agrees, passes the screen check, reads the instructions."""
        event = {
            "seq": 0,
            "presentation_id": None,
            "kind": "observer",
            "t_ms": 0,
            "detail": self._judge.describe(),
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
        if page["screen"] is not None:
            client.post("/api/screen", **self._screen(page["screen"]))
        client.post("/api/instructions")

    def _screen(self, rules: dict[str, Any]) -> dict[str, Any]:
        """A screen that fits: refresh rate of the clips, distance for a density in the limits."""
        distance = rules["distance_mm"]["usual"] if rules["distance_mm"] else None
        if distance and rules["px_per_degree"]:
            per_mm = PX_PER_MM * 0.017454
            middle = sum(rules["px_per_degree"]) / 2 / per_mm
            distance = min(max(middle, rules["distance_mm"]["min"]), rules["distance_mm"]["max"])
        return {
            "environment": ENVIRONMENT,
            "codec_plays": True,
            "fullscreen": True,
            "refresh_hz": max(rules["frame_rates_hz"]),
            "css_px_per_mm": None if rules["calibration"] == "off" else PX_PER_MM,
            "viewing_distance_mm": distance,
        }

    def _answer(self, client: HttpClient, trial: dict[str, Any]) -> dict[str, Any]:
        for clip in trial["clips"]:
            self._fetched.fetch(client, clip)
        length_ms = 1000 * max(clip["duration_s"] for clip in trial["clips"])
        onset_ms = self._clock_ms + 800
        self._clock_ms = onset_ms + length_ms * len(trial["clips"]) + 4000
        responses: list[dict[str, Any]] = []
        for question, answers in self._judge.judge_trial(trial):
            is_turned = question.key in trial["reversed"]
            responses += self._rows(question, answers, "video_end", is_turned=is_turned)
        played = {
            "num_plays": 1,
            "onset_ms": onset_ms,
            "first_frame_ms": 0,
            "ended_ms": onset_ms + length_ms,
            "frames_dropped": 0,
            "stall_count": 0,
            "stall_ms": 0,
        }
        presentation = {
            "presentation_id": client.new_id(),
            **played,
            "frames_total": sum(clip["num_frames"] for clip in trial["clips"]),
            "hidden_ms": 0,
            "fullscreen": False,
            "displayed_w": trial["clips"][0]["width_px"],
            "displayed_h": trial["clips"][0]["height_px"],
            "completed": True,
            "device_pixel_ratio": 1,
            "scale": 1,
            "clips": [
                {
                    "position": i,
                    "sha256": clip["sha256"],
                    **played,
                    "frames_total": clip["num_frames"],
                }
                for i, clip in enumerate(trial["clips"])
            ],
        }
        return {
            "trial_id": trial["trial_id"],
            "presentation": presentation,
            "responses": responses,
        }

    def _answer_end(self) -> list[dict[str, Any]]:
        responses: list[dict[str, Any]] = []
        for question, answers in self._judge.judge_session():
            responses += self._rows(question, answers, "form_shown")
        return responses

    def _rows(
        self,
        question: Question,
        answers: Answers,
        origin: str,
        *,
        is_turned: bool = False,
    ) -> list[dict[str, Any]]:
        rt_ms = round(1500 * self._rng.lognormvariate(0, 0.35), 1)
        return [
            {
                "question": question.key,
                "item": item,
                "value": answer.value,
                "value_text": answer.value_text,
                "rt_ms": rt_ms,
                "rt_origin": origin,
                "first_touch_ms": rt_ms,
                "num_changes": 0,
                "reversed": is_turned,
            }
            for item, answer in answers.items()
        ]
