# SPDX-License-Identifier: MIT
"""`verisim study …` and `verisim export`: show clips to people and hand out their answers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from verisim.commands.messages import progress_bar, say

app = typer.Typer(help="Run a study: people rate clips in a browser.", no_args_is_help=True)

StudyFile = Annotated[Path, typer.Argument(help="Study file (YAML).", show_default=False)]
Clips = Annotated[
    Path | None,
    typer.Option(help="Folder that `verisim stimuli build` made. Default: out/stimuli/SET."),
]
Database = Annotated[
    Path | None, typer.Option(help="SQLite file with the answers. Default: out/NAME.db.")
]


def _places(study_file: Path, clips: Path | None, db: Path | None) -> tuple[Path, Path]:
    from verisim.study.server.study_file import load_study

    study = load_study(study_file)
    return clips or Path("out/stimuli") / study.set, db or Path("out") / f"{study.name}.db"


@app.command()
def serve(
    study_file: StudyFile,
    clips: Clips = None,
    db: Database = None,
    port: Annotated[int, typer.Option(min=0, max=65535)] = 8000,
    host: Annotated[
        str,
        typer.Option(
            help="Address to listen on. Anything but 127.0.0.1 lets other machines reach the "
            "participants' page, unencrypted: put a reverse proxy with TLS in front."
        ),
    ] = "127.0.0.1",
) -> None:
    """Serve a study to participants until Ctrl-C; answers go to the database at once."""
    from verisim.study.server import serve as serve_study

    set_dir, db_file = _places(study_file, clips, db)

    def ready(url: str) -> None:
        say(f"participants: {url}\nanswers: {db_file}\nCtrl-C ends the study.")

    serve_study(study_file, set_dir, db_file, host, port, on_ready=ready)
    say(f"closed; export with: verisim export --db {db_file} -o out/export")


@app.command()
def simulate(
    study_file: StudyFile,
    participants: Annotated[int, typer.Option(min=1, help="Number of scripted raters.")],
    clips: Clips = None,
    db: Database = None,
    seed: Annotated[int, typer.Option(help="Of the raters' noise.")] = 1,
) -> None:
    """Let scripted raters answer through the real HTTP interface; marked source=simulated."""
    from verisim.study.server import simulate as simulate_study

    set_dir, db_file = _places(study_file, clips, db)
    with progress_bar("raters", counts=True) as report:
        simulate_study(study_file, set_dir, db_file, participants, seed, on_progress=report)
    say(f"answers: {db_file}")


def register_export(root: typer.Typer) -> None:
    @root.command()
    def export(
        db: Annotated[Path, typer.Option(help="Database of a study.")],
        output: Annotated[Path, typer.Option("-o", "--output", help="Folder for the tables.")],
        blind: Annotated[
            bool, typer.Option(help="Leave out which scene and setting a clip is.")
        ] = False,
        force: Annotated[bool, typer.Option(help="Replace an existing export.")] = False,
    ) -> None:
        """Write tidy tables with a codebook (Psych-DS) from a study's database."""
        from verisim.study.export import export as export_study

        export_study(db, output, blind=blind, force=force)
        typer.echo(str(output))
