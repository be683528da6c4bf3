# SPDX-License-Identifier: MIT
"""`verisim check STUDY` and `verisim study …` from the command line, without the server."""

from __future__ import annotations

from pathlib import Path

import pytest
from study_tools import BETWEEN, FULL, write_study
from typer.testing import CliRunner, Result

from verisim.cli import app
from verisim.study.server.kiosk import find_browser, kiosk_command


@pytest.fixture
def study(tmp_path: Path) -> Path:
    return write_study(tmp_path, FULL)


def run(*words: object, text: str | None = None) -> Result:
    result = CliRunner().invoke(app, [str(word) for word in words], input=text)
    assert result.exit_code == 0, (words, result.output, result.exception)
    return result


def test_check_prints_the_design(tmp_path: Path, set_dir: Path) -> None:
    shown = run("check", write_study(tmp_path, BETWEEN), "--clips", set_dir).output
    assert "trials of a participant  5: 1 practice, 3 test, 1 catch" in shown
    assert "between participants     drop, stack, 2 participants each" in shown
    assert "   40  drop__stiffness-high__s1" in shown


def test_check_names_clips_that_are_missing(tmp_path: Path, set_dir: Path) -> None:
    text = BETWEEN.replace("factor: scene", "factor: colour")
    path = write_study(tmp_path, text)
    result = CliRunner().invoke(app, ["check", str(path), "--clips", str(set_dir)])
    assert result.exit_code == 1 and "'colour' has 0 levels" in result.output


def test_a_study_is_frozen_linked_backed_up_and_verified(
    study: Path, set_dir: Path, tmp_path: Path
) -> None:
    db = tmp_path / "out.db"
    places = ("--clips", set_dir, "--db", db)
    assert run("study", "freeze", study, "--clips", set_dir).output.strip().endswith("frozen.json")
    links = run("study", "links", study, "--num", 3, "--label", "class", *places).output
    assert links.startswith("label,link\n") and links.count("/?link=") == 3
    closed = run("study", "links", study, "--close", "--label", "class", *places).output
    assert closed.startswith("3 links closed")
    word = "four random words here\n"
    run("study", "admin-password", "ada", "--study", study, *places, text=word * 2)
    copy = run("study", "backup", study, "--db", db, "-o", tmp_path / "copies").output.strip()
    assert "whole" in run("study", "verify", "--db", copy).output
    assert run("study", "forget-ids", "--db", db).output.startswith("0 outside")
    refused = CliRunner().invoke(app, ["study", "erase", "nobody", "--db", str(db)])
    assert refused.exit_code == 1 and "no participant 'nobody'" in str(refused.exception)


def test_the_kiosk_shows_the_page_alone_in_a_profile_of_its_own(tmp_path: Path) -> None:
    command = kiosk_command(find_browser(), "http://127.0.0.1:8000", tmp_path)
    assert command[-1] == "http://127.0.0.1:8000" and "--kiosk" in command
    assert f"--user-data-dir={tmp_path}" in command and "--no-sandbox" not in command
