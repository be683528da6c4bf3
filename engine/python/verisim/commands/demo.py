# SPDX-License-Identifier: MIT
"""`verisim demo`: the whole loop on a small study, from scenes to a report."""

from __future__ import annotations

import importlib.resources
import os
from pathlib import Path
from typing import Annotated

import typer

from verisim.commands.messages import progress_bar, say

COST_REPEATS = 5
RATER_SEED = 1


def _resource(package: str, *parts: str) -> Path:
    """A file that ships with the package (always real files, never a zip)."""
    return Path(str(importlib.resources.files(package).joinpath(*parts)))


def register(app: typer.Typer) -> None:
    @app.command()
    def demo(
        participants: Annotated[
            int,
            typer.Option(min=0, help="Scripted raters that answer first; marked as simulated."),
        ] = 0,
        serve: Annotated[
            bool, typer.Option(help="Serve the study to people when the clips are made.")
        ] = True,
        output: Annotated[
            Path, typer.Option("-o", "--output", help="Folder for everything the demo makes.")
        ] = Path("out/demo"),
        port: Annotated[int, typer.Option(min=0, max=65535)] = 8000,
    ) -> None:
        """The whole loop on a small study: about 12 clips, their cost, the study page, a report.

        Builds the clips of the set `demo` (kept when nothing changed), measures what each cost to
        compute and serves the study at http://127.0.0.1:PORT until Ctrl-C. With --participants N,
        N scripted raters answer through the same pages' interface first, and a report is made.
        """
        from verisim import stimuli

        set_file = _resource("verisim.stimuli", "sets", "demo.yaml")
        study_file = _resource("verisim.study", "studies", "seed_questions.yaml")
        set_dir = output / "stimuli"
        say("1. stimuli: simulate and render")
        with progress_bar("clips", counts=True) as report:
            stimuli.build_set(set_file, set_dir, progress=report)
        say(f"2. cost: {COST_REPEATS} serial runs of each setting")
        with progress_bar("runs", counts=True) as report:
            stimuli.measure_cost(set_file, set_dir, repeats=COST_REPEATS, progress=report)
        if participants:
            _simulate(study_file, set_dir, output, participants)
        if serve:
            _serve(study_file, set_dir, output, port)


def _simulate(study_file: Path, set_dir: Path, output: Path, participants: int) -> None:
    from verisim import analysis
    from verisim.study.export import export
    from verisim.study.server import simulate

    db = output / "simulated.db"
    export_dir = output / "simulated-export"
    report_dir = output / "simulated-report"
    db.unlink(missing_ok=True)
    say(f"3. study: {participants} scripted raters (their answers are simulated, and say so)")
    with progress_bar("raters", counts=True) as report:
        simulate(study_file, set_dir, db, participants, RATER_SEED, on_progress=report)
    say("4. export and report")
    export(db, export_dir, force=True)
    analysis.analyse(export_dir, report_dir, force=True)
    say(f"   ratings of scripted raters: {_shown(export_dir)}")
    say(f"   report: {_shown(report_dir / 'report.html')}")


def _serve(study_file: Path, set_dir: Path, output: Path, port: int) -> None:
    from verisim.study.server import serve

    db = output / "study.db"

    def ready(url: str) -> None:
        say(f"\nThe study is open: {url}")
        say("Rate the clips in a browser as a participant would. Ctrl-C ends the study.")

    serve(study_file, set_dir, db, port=port, on_ready=ready)
    say("\nThe study is closed; every answer is in " + _shown(db))
    say("Next:")
    say(f"  verisim export --db {_shown(db)} -o {_shown(output / 'export')}")
    say(f"  verisim analyse {_shown(output / 'export')} -o {_shown(output / 'report')}")


def _shown(path: Path) -> str:
    return os.path.relpath(path)
