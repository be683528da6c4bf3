# SPDX-License-Identifier: MIT
"""The part of `verisim check` that prints a study's design."""

from __future__ import annotations

from pathlib import Path

import typer

from verisim.commands.messages import say

MAX_LISTED = 40


def is_study(file: Path) -> bool:
    """True for a file that holds the keys of a study."""
    if file.is_dir():
        return False
    lines = file.read_text("utf-8", errors="replace").splitlines()
    keys = {line.split(":")[0] for line in lines if line[:1].isalpha()}
    return "questions" in keys or "consent" in keys


def _folder(file: Path, clips: Path | None) -> Path:
    from verisim.study.server.study_file import load_study

    return clips or Path("out/stimuli") / load_study(file).set


def design_problems(file: Path, clips: Path | None) -> list[str]:
    """What makes the design impossible with the clips that are there; [] where there are none."""
    from verisim.study.problems import StudyError
    from verisim.study.server.design import find_design_problems, load_both

    folder = _folder(file, clips)
    if clips is None and not (folder / "manifest.csv").is_file():
        return []
    try:
        study, stimuli = load_both(file, folder)
    except StudyError as error:
        return [str(problem) for problem in error.problems]
    return [f"{file}: {problem}" for problem in find_design_problems(study, stimuli)]


def print_design(file: Path, clips: Path | None) -> None:
    """Prints trials per participant, minutes and cell counts."""
    from verisim.study.server.design import describe_design, load_both

    folder = _folder(file, clips)
    if not (folder / "manifest.csv").is_file():
        say(f"no clips in {folder}: build them to see the design")
        return
    study, stimuli = load_both(file, folder)
    design = describe_design(study, stimuli)
    kinds = ", ".join(f"{num} {kind}" for kind, num in design.trials.items())
    typer.echo(f"trials of a participant  {sum(design.trials.values())}: {kinds}")
    typer.echo(f"minutes (estimate)       {design.minutes:.0f}")
    if design.cells != [""]:
        quota = f", {design.quota} participants each" if design.quota else ""
        typer.echo(f"between participants     {', '.join(design.cells)}{quota}")
    for line in design.lines:
        typer.echo(line)
    typer.echo(f"shown over the first {design.lists} lists of each cell:")
    for name, num in sorted(design.shown.items())[:MAX_LISTED]:
        typer.echo(f"  {num:5d}  {name}")
    if len(design.shown) > MAX_LISTED:
        typer.echo(f"  … and {len(design.shown) - MAX_LISTED} more")
