# SPDX-License-Identifier: MIT
"""`verisim bench --stability`: maps end to end, resumed after a kill, wrong arguments refused."""

from __future__ import annotations

import csv
import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

Command = Callable[..., "subprocess.CompletedProcess[str]"]
SMALL = ("--stability", "--quick", "--maps", "restitution,stiffness_step", "--methods", "seed")


def rows_of(file: Path) -> list[dict[str, str]]:
    with file.open(newline="") as stream:
        return list(csv.DictReader(stream))


def test_a_quick_map_is_predicted_run_drawn_and_kept(tmp_path: Path, bench: Command) -> None:
    first = bench(*SMALL, "-o", "maps", "-j", 1, "--json")
    assert first.returncode == 0, first.stderr
    found = json.loads(first.stdout)
    out = tmp_path / "maps"
    predictions, outcomes = rows_of(out / "predictions.csv"), rows_of(out / "outcomes.csv")
    assert len(predictions) == len(outcomes) == found["run"] == 60
    assert [row["predicted"] for row in predictions] == [row["predicted"] for row in outcomes]
    for before, after in zip(predictions, outcomes, strict=True):
        assert (before["map"], before["x"], before["y"]) == (after["map"], after["x"], after["y"])

    total = found["scores"][-1]
    assert total["map"] == "all"
    # Measured: 60 of 60, and 33 with each map's most frequent outcome.
    assert total["right"] >= 0.95 * total["cells"]
    assert total["trivial"] < 0.7 * total["cells"]
    codes = {row["outcome"] for row in outcomes if row["map"] == "stiffness_step"}
    assert {"ok", "S", "X", "D"} <= codes  # the seed fails in each way that the formulas name

    for name in ("stiffness_step__seed", "restitution__seed"):
        svg = (out / "figures" / f"{name}.svg").read_text()
        assert svg.count("<title>") == 30  # a tooltip for each cell
        assert "predicted border" in svg
        assert (out / "figures" / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    page = (out / "index.html").read_text()
    assert "Where methods fail" in page
    assert not re.findall(r'(?:src|href)="(?!#)[^"]*"', page)  # nothing from outside

    again = bench(*SMALL, "-o", "maps", "-j", 1, "--json")
    kept = json.loads(again.stdout)
    assert (kept["run"], kept["kept"]) == (0, 60)
    assert kept["scores"] == found["scores"]
    assert kept["predictions_changed_after_run"] == 0


def test_a_killed_bench_looks_incomplete_and_goes_on(tmp_path: Path, bench: Command) -> None:
    out = tmp_path / "maps"
    command = [sys.executable, "-m", "verisim", "bench", *SMALL, "-o", "maps", "-j", "1"]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.DEVNULL)
    runs, limit = out / "runs.csv", time.monotonic() + 200
    while not runs.is_file() or runs.read_text().count("\n") < 5:
        assert time.monotonic() < limit and process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert (out / "predictions.csv").is_file()
    assert not (out / "outcomes.csv").exists()
    assert not (out / "index.html").exists()
    whole = runs.read_text().count("\n") - 1
    last = rows_of(out / "predictions.csv")[-1]["inputs_sha256"]
    row = runs.read_text().splitlines()[1].split(",")
    with runs.open("a") as stream:  # a row that lacks only its end, as a kill may leave it
        stream.write(",".join([last, *row[1:-1], "cut-off"]))

    done = bench(*SMALL, "-o", "maps", "-j", 2, "--json")
    found = json.loads(done.stdout)
    assert found["kept"] == whole
    assert found["run"] + whole == 60
    assert len(rows_of(out / "outcomes.csv")) == 60
    assert "cut-off" not in runs.read_text()


def test_a_prediction_that_changed_after_the_run_is_owned_up_to(
    tmp_path: Path, bench: Command
) -> None:
    arguments = (*SMALL[:3], "restitution", *SMALL[4:], "-o", "maps", "-j", 1, "--json")
    bench(*arguments)
    runs = tmp_path / "maps" / "runs.csv"
    lines = runs.read_text().splitlines()
    at = lines[0].split(",").index("predicted_before")
    fields = lines[1].split(",")
    fields[at] = "J"
    runs.write_text("\n".join([lines[0], ",".join(fields), *lines[2:]]) + "\n")
    found = json.loads(bench(*arguments).stdout)
    assert found["predictions_changed_after_run"] == 1
    assert "1 cells were run" in (tmp_path / "maps" / "index.html").read_text()


def test_wrong_arguments_are_refused_with_what_is_allowed(tmp_path: Path, bench: Command) -> None:
    mixed = bench("bounce", "-o", "maps", "--stability")
    assert mixed.returncode == 2
    assert "SCENE goes without --stability" in mixed.stderr

    unknown = bench("--stability", "-o", "maps", "--maps", "tower,towers", "--methods", "dam")
    assert unknown.returncode == 2
    assert "saw 'towers'" in unknown.stderr and "mass_ratio" in unknown.stderr
    assert "saw 'dam'" in unknown.stderr and "dem-hybrid" in unknown.stderr
    assert "hint:" in unknown.stderr
    assert not (tmp_path / "maps").exists()

    empty = bench("--stability", "-o", "maps", "--maps", "particle_size", "--methods", "dem-hybrid")
    assert empty.returncode == 2
    assert "no map of particle_size can be posed for dem-hybrid" in empty.stderr

    (tmp_path / "file").write_text("")
    onto_file = bench("--stability", "-o", "file", "--maps", "restitution")
    assert onto_file.returncode == 2
    assert "file" in onto_file.stderr and "hint:" in onto_file.stderr
