# SPDX-License-Identifier: MIT
"""What the study tests share: tiny clips, a study file, a server process, a participant."""

from __future__ import annotations

import atexit
import contextlib
import csv
import hashlib
import json
import logging
import multiprocessing
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
import uuid
from dataclasses import dataclass
from functools import cache
from multiprocessing.connection import Connection
from pathlib import Path
from types import TracebackType
from typing import Any

import httpx

from verisim.study.problems import StudyError
from verisim.study.server import serve
from verisim.study.server.database import prepare_database, read_place

NUM_FRAMES, FRAME_RATE_HZ = 10, 30

STUDY = """\
schema: 1
name: mini
title: A mini study
contact: the tester
set: mini
languages: [en]
consent: consent.md
instructions: instructions.md
thanks: thanks.md
trial: {layout: single, replays: 1, fixation_ms: [0, 100], rest_every: 3}
questions:
  - {key: realism, kind: rating, points: 7, prompt: {en: How real?}, ends: {en: [not, very]}}
  - key: speed
    kind: bipolar
    points: 5
    prompt: {en: How fast?}
    ends: {en: [too slow, too fast]}
    middle: {en: right}
  - {key: fun, kind: slider, prompt: {en: Fun?}, ends: {en: [no, yes]}}
  - {key: note, kind: comment, max_chars: 50, prompt: {en: Anything?}}
order: {sampler: random, seed: 7, never_twice_running: scene}
exclude: {missed_catch: 1, median_rt_below_ms: 400}
analysis: {primary: realism, equivalence_margin: 0.1}
"""

ENVIRONMENT = {
    "browser": "Chromium",
    "browser_version": "1",
    "os": "Linux",
    "is_mobile": False,
    "screen_w": 1920,
    "screen_h": 1080,
    "viewport_w": 1280,
    "viewport_h": 720,
    "device_pixel_ratio": 1.25,
    "refresh_hz": 59.9,
    "language": "en-GB",
    "tz_offset_min": -60,
    "app_version": "0.1.0",
}


def write_study(folder: Path, text: str = STUDY) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "consent.md").write_text("# {title}\n\nAsk {contact}.\n\nVersion: 3\n")
    (folder / "instructions.md").write_text("Watch, then answer.\n")
    (folder / "thanks.md").write_text("Thank you.\n")
    path = folder / "mini.yaml"
    path.write_text(text)
    return path


def build_stimuli(directory: Path, *, filler_bytes: int = 0) -> None:
    """Makes eight clips with ffmpeg, and manifest, sidecars and costs as a build writes them."""
    clips = directory / "clips"
    clips.mkdir(parents=True)
    rows: list[dict[str, Any]] = []
    levels = {"low": 0.03, "mid": 0.005, "high": 0.0}
    for scene in ("drop", "stack"):
        for i, (level, depth_m) in enumerate(levels.items()):
            reference = "" if level == "high" else f"{scene}__stiffness-high__s1"
            rows.append(_clip(clips, scene, "test", level, depth_m, reference, filler_bytes + i))
    rows.append(_clip(clips, "roll", "practice", "mid", 0.001, "", filler_bytes))
    rows.append(_clip(clips, "vanish", "catch", "mid", 0.2, "", filler_bytes))
    with (directory / "manifest.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    (directory / "set.json").write_text(json.dumps({"schema": 1, "name": "mini"}))
    with (directory / "cost.csv").open("w", newline="", encoding="utf-8") as file:
        file.write(
            "stimulus,method,machine,build,num_runs,cpu_s_per_sim_s_median,cpu_s_per_sim_s_min,"
            "cpu_s_per_sim_s_q1,cpu_s_per_sim_s_q3,steps,dt_s,stiffness_n_m,particle_size_m\n"
        )
        for i, row in enumerate(rows):
            cost = 0.5 + i
            file.write(
                f"{row['stimulus']},seed,m1,b1,5,{cost},{cost},{cost},{cost},9,1e-4,1,0.01\n"
            )


def _clip(
    clips: Path, scene: str, role: str, level: str, depth_m: float, reference: str, shade: int
) -> dict[str, Any]:
    name = f"{scene}__stiffness-{level}__s1"
    path = clips / f"{name}.mp4"
    colour = hashlib.sha256(f"{name}{shade}".encode()).hexdigest()[:6]
    source = f"color=c=0x{colour}:s=64x48:r={FRAME_RATE_HZ}"
    encode = ["-frames:v", str(NUM_FRAMES), "-c:v", "libx264", "-pix_fmt", "yuv420p"]
    subprocess.run(
        ["/usr/bin/ffmpeg", "-v", "error", "-f", "lavfi", "-i", source, *encode, str(path)],
        check=True,
    )
    sha256 = hashlib.sha256(path.read_bytes()).hexdigest()
    sidecar = {
        "schema": 1,
        "stimulus": name,
        "scene": scene,
        "scene_sha256": hashlib.sha256(scene.encode()).hexdigest(),
        "engine_version": "0.1.0",
        "method": "seed",
        "parameters": {"dt_s": 1e-4, "stiffness_n_m": 1e4, "particle_size_m": 0.01},
        "metrics": {"max_penetration_m": depth_m, "energy_residual_rel": 1e-9, "max_contacts": 4},
        "failed": None,
        "error_to_reference_m": depth_m * 2 if reference else None,
        "state_hash": "0" * 64,
        "video_sha256": sha256,
    }
    path.with_suffix(".json").write_text(json.dumps(sidecar))
    return {
        "stimulus": name,
        "scene": scene,
        "role": role,
        "method": "seed",
        "seed": 1,
        "reference": reference,
        "file": f"clips/{name}.mp4",
        "sha256": sha256,
        "num_bytes": path.stat().st_size,
        "width_px": 64,
        "height_px": 48,
        "frame_rate_hz": FRAME_RATE_HZ,
        "num_frames": NUM_FRAMES,
        "duration_s": NUM_FRAMES / FRAME_RATE_HZ,
        "content_key": sha256[:16],
        "factor_stiffness": level,
    }


# Servers are forked from one process that has imported the server: that spares 1.6 s of CPU each.
FORKS = multiprocessing.get_context("forkserver")
FORKS.set_forkserver_preload(["verisim.study.server.run_server", "httpx"])


def run_server(
    arguments: tuple[Path, Path, Path | str, int, str, dict[str, Any]],
    errors: Path,
    told: Connection,
    environment: dict[str, str],
) -> None:
    """What the server's process does: tells its addresses, and ends as the command does."""
    os.environ.clear()
    os.environ.update(environment)
    time.tzset()
    with errors.open("a") as file:
        os.dup2(file.fileno(), 2)
    study, set_dir, db, port, key, options = arguments
    logging.basicConfig(level=logging.INFO)
    admin: list[str] = []
    try:
        serve(
            study,
            set_dir,
            read_place(str(db)),
            port=port,
            source_default="lab",
            simulate_key=key or None,
            on_admin=admin.append,
            on_ready=lambda address: told.send([address, *admin]),
            **options,
        )
    except StudyError as error:
        print(error, file=sys.stderr)
        sys.exit(1)


@cache
def empty_database() -> Path:
    """A database with tables and no rows, to start from: that spares each server 0.4 s of CPU."""
    folder = tempfile.TemporaryDirectory(prefix="verisim-")
    atexit.register(folder.cleanup)
    database = Path(folder.name) / "empty.db"
    prepare_database(database)
    return database


READY_S = 60  # a machine with much else to do takes its time


class Server:
    """The real server in a process of its own, so that it can be killed."""

    def __init__(
        self,
        study: Path,
        set_dir: Path,
        db: Path | str,
        *,
        port: int = 0,
        simulate_key: str = "",
        **options: Any,
    ) -> None:
        self.study, self.set_dir, self.db = study, set_dir, db
        self.options, self.admin = options, ""
        self.port, self.simulate_key = port, simulate_key
        self.address = ""
        self._folder = tempfile.TemporaryDirectory(prefix="verisim-")
        self._errors = Path(self._folder.name) / "stderr"
        if isinstance(db, Path) and not db.exists():
            shutil.copy(empty_database(), db)
        self.start()

    def start(self) -> None:
        """Starts the server; where it refuses to serve, `wait` gives its exit status."""
        arguments = (
            self.study,
            self.set_dir,
            self.db,
            self.port,
            self.simulate_key,
            self.options,
        )
        hears, tells = FORKS.Pipe(duplex=False)
        self.process = FORKS.Process(
            target=run_server, args=(arguments, self._errors, tells, dict(os.environ))
        )
        self.process.start()
        tells.close()
        told = []
        assert hears.poll(READY_S), "the study server did not start"
        with contextlib.suppress(EOFError):  # it ended instead
            told = hears.recv()
        self.address, self.admin, *_ = [*told, "", ""]

    def kill(self) -> None:
        self.process.kill()
        self.process.join()

    def wait(self) -> int | None:
        """Returns the exit status."""
        self.process.join(READY_S)
        return self.process.exitcode

    def interrupt(self) -> int | None:
        """Presses Ctrl-C and returns the exit status."""
        assert self.process.pid is not None
        os.kill(self.process.pid, signal.SIGINT)
        return self.wait()

    def read_errors(self) -> str:
        return self._errors.read_text()

    def query(self, sql: str, *values: Any) -> list[Any]:
        with sqlite3.connect(self.db) as connection:
            return connection.execute(sql, values).fetchall()

    def client(self, token: str = "") -> httpx.Client:
        headers = {"authorization": f"Bearer {token}"} if token else {}
        return httpx.Client(base_url=self.address, headers=headers, timeout=20, trust_env=False)

    def __enter__(self) -> Server:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.process.terminate()
        if self.wait() is None:
            self.kill()
        self._folder.cleanup()


FULL = STUDY.replace(
    """trial: {layout: single, replays: 1, fixation_ms: [0, 100], rest_every: 3}
""",
    """trial: {layout: single, replays: 1, fixation_ms: [0, 100], rest_every: 3}
screen: {phone: refuse, refresh: flag, fullscreen: offer, calibration: offer,
  distance_mm: [300, 600, 1500], px_per_degree: [10, 90], min_viewport_px: [640, 480]}
practice: {feedback: true, question: plausible, answers: {roll__stiffness-mid__s1: 1}}
end_questions:
  - {key: age, kind: category, prompt: {en: Age?}, options: {young: {en: "<40"}, old: {en: "40+"}}}
  - {key: last, kind: comment, prompt: {en: Anything else?}}
completion: {code: DONE42, return_url: "https://example.org/complete?cc={code}",
  partial: {from_share: 0.2, code: PART}, screened_out: {code: OUT}}
""",
).replace(
    """  - {key: fun, kind: slider""",
    """  - {key: plausible, kind: yes_no, prompt: {en: Possible?}}
  - {key: laws, kind: checklist, prompt: {en: Laws?}, ask: {if: realism <= 3},
     items: {gravity: {en: gravity}, solid: {en: solid}}}
  - {key: where, kind: mark, prompt: {en: Where?}, ask: {if: plausible == 0}, max_marks: 2}
  - {key: fun, kind: slider""",
)
BETWEEN = STUDY.replace("seed: 7,", "seed: 7, between: {factor: scene, quota: 2},")
PAIRS = (
    STUDY.replace("layout: single", "layout: [sequential, side_by_side]")
    .replace(
        "questions:\n",
        "questions:\n  - {key: which, kind: choice, not_sure: true, prompt: {en: Which?}}\n"
        "  - {key: sure, kind: confidence, points: 3, ask: {if: which != not_sure}}\n",
    )
    .replace("never_twice_running: scene", "pairs: {with: reference}")
    .replace("primary: realism", "primary: which")
)
TRACKS = STUDY.replace(
    "questions:\n",
    "questions:\n  - {key: plausible, kind: yes_no, prompt: {en: Possible?}}\n",
).replace(
    "order: {sampler: random, seed: 7, never_twice_running: scene}",
    """order:
  sampler: quest_plus
  seed: 7
  question: plausible
  tracks:
    - {name: up, factor: size, undistorted: 1, direction: up, scale: ratio, trials: 6}""",
)


def new_id() -> str:
    return str(uuid.uuid4())


def session_body(**changes: Any) -> dict[str, Any]:
    return {
        "submission_id": new_id(),
        "source": "lab",
        "simulate_key": None,
        "environment": ENVIRONMENT,
        **changes,
    }


def trial_body(trial_id: int, **changes: Any) -> dict[str, Any]:
    """A full answer to a trial; keyword arguments replace top-level keys."""
    return {
        "submission_id": new_id(),
        "trial_id": trial_id,
        "presentation": presentation(),
        "responses": [
            response("realism", 4),
            response("speed", 3),
            response("fun", 61.5),
            response("note", None, "went well"),
        ],
        **changes,
    }


def presentation(**changes: Any) -> dict[str, Any]:
    return {
        "presentation_id": new_id(),
        "num_plays": 1,
        "onset_ms": 12.5,
        "first_frame_ms": 3.25,
        "ended_ms": 345.0,
        "frames_total": NUM_FRAMES,
        "frames_dropped": 0,
        "stall_count": 0,
        "stall_ms": 0,
        "hidden_ms": 0,
        "fullscreen": False,
        "displayed_w": 640,
        "displayed_h": 480.5,
        "completed": True,
        **changes,
    }


def response(question: str, value: float | None, text: str | None = None) -> dict[str, Any]:
    return {
        "question": question,
        "value": value,
        "value_text": text,
        "rt_ms": 812.5,
        "rt_origin": "video_end",
        "first_touch_ms": 500,
        "num_changes": 1,
    }


@dataclass
class Person:
    """A participant who goes through the study over HTTP."""

    server: Server
    token: str
    participant_id: str
    session_id: str
    client: httpx.Client

    @classmethod
    def arrive(cls, server: Server, **changes: Any) -> Person:
        with server.client() as client:
            reply = client.post("/api/sessions", json=session_body(**changes))
        assert reply.status_code == 201, reply.text
        opened = reply.json()
        return cls(server, **opened, client=server.client(opened["token"]))

    @classmethod
    def ready(cls, server: Server, **changes: Any) -> Person:
        """Arrives, agrees and reads the instructions."""
        person = cls.arrive(server, **changes)
        assert person.agree().status_code == 201
        assert person.post("instructions", submission_id=new_id()).status_code == 201
        return person

    def agree(self, **changes: Any) -> httpx.Response:
        form = self.client.get("/api/study").json()["consent"]
        body = {
            "submission_id": new_id(),
            "agreed": True,
            "form_version": form["version"],
            "form_sha256": form["sha256"],
            "language": "en",
        }
        return self.post("consent", **{**body, **changes})

    def post(self, kind: str, **body: Any) -> httpx.Response:
        return self.client.post(f"/api/{kind}", json=body)

    def next(self) -> dict[str, Any]:
        reply = self.client.get("/api/next")
        assert reply.status_code == 200, reply.text
        step: dict[str, Any] = reply.json()
        return step

    def trial(self) -> dict[str, Any]:
        trial = self.next()["trial"]
        assert isinstance(trial, dict)
        return trial

    def answer_next(self) -> httpx.Response:
        return self.post("trials", **trial_body(self.trial()["trial_id"]))

    def finish(self) -> dict[str, Any]:
        while (step := self.next())["step"] == "trial":
            reply = self.post("trials", **trial_body(step["trial"]["trial_id"]))
            assert reply.status_code == 201, reply.text
        return step


def error_code(reply: httpx.Response) -> str:
    return str(reply.json()["error"]["code"])
