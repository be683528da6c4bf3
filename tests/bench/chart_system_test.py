# SPDX-License-Identifier: MIT
"""`verisim bench`: a chart end to end, resumed after a kill, run anew after a change; wrong use."""

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
SMALL = ("bounce", "--quick", "--methods", "dem")


def rows_of(file: Path) -> list[dict[str, str]]:
    with file.open(newline="") as stream:
        return list(csv.DictReader(stream))


def test_a_scene_is_run_charted_and_kept(tmp_path: Path, bench: Command) -> None:
    first = bench(*SMALL, "-o", "out", "--json")
    assert first.returncode == 0, first.stderr
    found, out = json.loads(first.stdout), tmp_path / "out"
    rows = rows_of(out / "bounce.csv")
    assert len(rows) == found["run"] and found["kept"] == 0
    settings = {row["setting"] for row in rows}
    assert len(rows) == 4 * len(settings)  # one that warms up and bears the error, three that cost
    assert {row["cost_counts"] for row in rows if row["run"] == "0"} == {"False"}
    assert all(row["machine"] and row["build"] and row["state_hash"] for row in rows)
    # Samples for errors change nothing: every run of a setting ends in the same state.
    for setting in settings:
        assert len({row["state_hash"] for row in rows if row["setting"] == setting}) == 1

    front = found["fronts"]
    assert [row["cpu_s_per_sim_s"] for row in front] == sorted(r["cpu_s_per_sim_s"] for r in front)
    assert [row["error"] for row in front] == sorted((r["error"] for r in front), reverse=True)
    assert front[-1]["error"] < 1e-4  # measured 7.6e-6

    svg = (out / "figures" / "bounce.svg").read_text()
    assert svg.count("<title>") == len(settings)  # a tooltip for each point
    assert (out / "figures" / "bounce.png").read_bytes().startswith(b"\x89PNG")
    page = (out / "index.html").read_text()
    assert "Verisim is one of the contestants" in page
    assert not re.findall(r'(?:src|href)="(?!#|bounce\.csv)[^"]*"', page)  # nothing from outside

    again = json.loads(bench(*SMALL, "-o", "out", "--json").stdout)
    assert (again["run"], again["kept"]) == (0, len(rows))
    assert again["fronts"] == front


def test_a_killed_bench_goes_on_and_a_changed_engine_runs_anew(
    tmp_path: Path, bench: Command
) -> None:
    table = tmp_path / "out" / "bounce.csv"
    command = [sys.executable, "-m", "verisim", "bench", *SMALL, "-o", "out"]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.DEVNULL)
    limit = time.monotonic() + 100
    while not table.is_file() or table.read_text().count("\n") < 4:
        assert time.monotonic() < limit and process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert not (tmp_path / "out" / "index.html").exists()
    whole = table.read_text().count("\n") - 1
    with table.open("a") as stream:
        stream.write("bounce,dem,cut-off")

    done = json.loads(bench(*SMALL, "-o", "out", "--json").stdout)
    assert done["kept"] == whole
    assert "cut-off" not in table.read_text()
    total = len(rows_of(table))
    assert done["run"] + whole == total

    build = rows_of(table)[0]["build"]
    table.write_text(table.read_text().replace(build, "another-engine"))
    anew = json.loads(bench(*SMALL, "-o", "out", "--json").stdout)
    assert (anew["run"], anew["kept"]) == (total, 0)
    assert len(rows_of(table)) == 2 * total  # what another engine did stays in the table


def test_wrong_arguments_are_refused_with_what_is_allowed(tmp_path: Path, bench: Command) -> None:
    unknown = bench("bounze", "-o", "out")
    assert unknown.returncode == 2
    assert "saw 'bounze'" in unknown.stderr and "incline_slip" in unknown.stderr
    assert "hint:" in unknown.stderr
    method = bench("bounce", "-o", "out", "--methods", "dem,dam")
    assert method.returncode == 2 and "saw 'dam'" in method.stderr and "seed" in method.stderr
    peer = bench("bounce", "-o", "out", "--peers", "physix")
    assert peer.returncode == 2 and "saw 'physix'" in peer.stderr and "mujoco" in peer.stderr
    maps = bench("bounce", "-o", "out", "--maps", "tower")
    assert maps.returncode == 2 and "--maps goes with --stability" in maps.stderr
    assert not list((tmp_path / "out").glob("*.csv"))
