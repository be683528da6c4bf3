# SPDX-License-Identifier: MIT
"""Building a set: complete, parallel, resumable, nothing twice, and no failure hides another."""

from __future__ import annotations

import csv
import fcntl
import json
import os
from pathlib import Path

import pytest
from small_sets import BALL_SET, write_set

from verisim.stimuli import SetError, StimuliError, build_set
from verisim.stimuli.expand import file_sha256

LOW, HIGH = "ball__stiffness-low__s1", "ball__stiffness-high__s1"


def rows_of(directory: Path) -> list[dict[str, str]]:
    with (directory / "manifest.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def sidecar_of(directory: Path, name: str) -> dict[str, object]:
    content: dict[str, object] = json.loads((directory / "clips" / f"{name}.json").read_text())
    return content


def stamps(directory: Path) -> dict[str, int]:
    return {f.name: f.stat().st_mtime_ns for f in sorted((directory / "clips").iterdir())}


@pytest.fixture
def built(library: Path) -> Path:
    directory = library / "out"
    result = build_set(library / "sets" / "small.yaml", directory)
    assert result.built == [LOW, HIGH] and result.kept == []
    return directory


def test_the_manifest_describes_every_clip_as_it_is_on_disk(built: Path) -> None:
    rows = rows_of(built)
    assert [row["stimulus"] for row in rows] == [LOW, HIGH]
    for row in rows:
        clip = built / row["file"]
        sidecar = sidecar_of(built, row["stimulus"])
        assert row["sha256"] == file_sha256(clip) == sidecar["video_sha256"]
        assert int(row["num_bytes"]) == clip.stat().st_size
        assert row["content_key"] == sidecar["content_key"]
        assert int(row["num_frames"]) == sidecar["num_frames"]
        assert float(row["duration_s"]) == pytest.approx(int(row["num_frames"]) / 60)
        assert (row["scene"], row["role"], row["seed"]) == ("ball", "test", "1")
        assert (row["width_px"], row["height_px"]) == ("64", "64")
        assert (built / "poses" / f"{row['stimulus']}.npz").is_file()
        for key in ("parameters", "metrics", "failed", "events", "state_hash", "frames_sha256",
                    "overrides", "engine_version", "method", "scene_sha256"):  # fmt: skip
            assert key in sidecar, key
    assert [row["factor_stiffness"] for row in rows] == ["low", "high"]
    assert [row["reference"] for row in rows] == [HIGH, ""]
    content = json.loads((built / "set.json").read_text())
    assert content["name"] == "small"
    assert content["factor_names"] == ["stiffness"]
    assert content["reference_levels"] == {"stiffness": "high"}


def test_the_error_to_the_reference_is_stored_and_empty_for_the_reference(built: Path) -> None:
    error = sidecar_of(built, LOW)["error_to_reference_m"]
    assert isinstance(error, float) and 1e-4 < error < 0.1  # the softer ball sinks in deeper
    assert sidecar_of(built, HIGH)["error_to_reference_m"] is None


def test_nothing_is_built_twice_and_only_what_changed_is_built_again(
    built: Path, library: Path
) -> None:
    file = library / "sets" / "small.yaml"
    before = stamps(built)
    assert build_set(file, built).built == []
    assert stamps(built) == before
    write_set(library, BALL_SET.replace("low: 500", "low: 600"))
    result = build_set(file, built)
    assert (result.built, result.kept) == ([LOW], [HIGH])


def test_a_damaged_clip_sidecar_or_pose_log_is_made_again_with_the_same_bytes(
    built: Path, library: Path
) -> None:
    file = library / "sets" / "small.yaml"
    manifest = (built / "manifest.csv").read_bytes()
    sidecar = (built / "clips" / f"{LOW}.json").read_bytes()
    for damaged in (f"clips/{LOW}.mp4", f"clips/{LOW}.json", f"poses/{LOW}.npz"):
        (built / damaged).write_bytes(b"{")
        assert build_set(file, built).built == [LOW], damaged
        assert (built / "manifest.csv").read_bytes() == manifest
        assert (built / "clips" / f"{LOW}.json").read_bytes() == sidecar


def test_an_interrupted_build_goes_on_where_it_was(library: Path) -> None:
    file, directory = library / "sets" / "small.yaml", library / "out"

    def stop(done: float, _total: float) -> None:
        if done >= 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        build_set(file, directory, jobs=1, progress=stop)
    assert not (directory / "manifest.csv").exists()
    (directory / "clips" / ".left_over.tmp").write_text("half a clip")
    result = build_set(file, directory, jobs=1)
    assert (result.built, result.kept) == ([HIGH], [LOW])
    assert not list((directory / "clips").glob(".*"))
    assert len(rows_of(directory)) == 2


def test_a_clip_that_cannot_be_made_is_named_and_the_others_are_kept(library: Path) -> None:
    file, directory = library / "sets" / "small.yaml", library / "out"
    blocker = directory / "clips" / f"{LOW}.mp4"
    blocker.mkdir(parents=True)  # nothing can be renamed onto a folder
    with pytest.raises(StimuliError, match=f"1 of 2 clips could not be made:\n{LOW}: "):
        build_set(file, directory)
    assert (directory / "clips" / f"{HIGH}.mp4").is_file()
    assert not (directory / "manifest.csv").exists()
    blocker.rmdir()
    assert build_set(file, directory).kept == [HIGH]


def test_a_manifest_never_stands_beside_an_incomplete_set(built: Path, library: Path) -> None:
    file = write_set(library, BALL_SET.replace("low: 500", "low: 600"))
    clip = built / "clips" / f"{LOW}.mp4"
    clip.unlink()
    clip.mkdir()
    with pytest.raises(StimuliError):
        build_set(file, built)
    assert not (built / "manifest.csv").exists()


def test_a_run_whose_physics_fails_still_gives_its_clip(library: Path) -> None:
    file = write_set(library, BALL_SET.replace("low: 500", "low: 0.001"))  # falls through
    result = build_set(file, library / "out")
    assert set(result.failed_runs) == {LOW}
    failed = sidecar_of(library / "out", LOW)["failed"]
    assert isinstance(failed, dict) and failed["body"] == "ball"
    assert len(rows_of(library / "out")) == 2


def test_one_and_two_workers_make_the_same_bytes(library: Path) -> None:
    file = library / "sets" / "small.yaml"
    for jobs in (1, 2):
        build_set(file, library / f"out{jobs}", jobs=jobs)
    one, two = ((library / f"out{jobs}" / "manifest.csv").read_bytes() for jobs in (1, 2))
    assert one == two


def test_progress_counts_clips_up_to_their_number(library: Path) -> None:
    seen: list[tuple[float, float]] = []
    build_set(library / "sets" / "small.yaml", library / "out",
              progress=lambda done, total: seen.append((done, total)))  # fmt: skip
    dones = [done for done, _ in seen]
    assert dones == sorted(dones) and dones[0] == 0 and dones[-1] == 2
    assert {total for _, total in seen} == {2}


def test_wrong_scenes_are_all_named_before_anything_runs(library: Path) -> None:
    text = BALL_SET.replace("[ball]", "[ball, other]").replace("low: 500", "low: -500")
    other = library / "scenes" / "other.yaml"
    other.write_text(other.read_text().replace("name: other", "name: elsewhere"))
    file = write_set(library, text)
    with pytest.raises(SetError) as caught:
        build_set(file, library / "out")
    message = str(caught.value)
    assert "physics.stiffness_n_m=-500" in message
    assert "name: saw elsewhere; allowed: other" in message
    assert not (library / "out").exists()


def test_two_builds_in_one_folder_are_refused(library: Path) -> None:
    directory = library / "out"
    directory.mkdir()
    lock = os.open(directory / ".lock", os.O_CREAT | os.O_WRONLY)
    fcntl.flock(lock, fcntl.LOCK_EX)
    try:
        with pytest.raises(StimuliError, match="another build is writing here"):
            build_set(library / "sets" / "small.yaml", directory)
    finally:
        os.close(lock)
