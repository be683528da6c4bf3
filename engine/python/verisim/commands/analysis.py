# SPDX-License-Identifier: MIT
"""`verisim analyse`: tables and one self-contained report from an export tree."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def register(app: typer.Typer) -> None:
    @app.command()
    def analyse(
        export: Annotated[Path, typer.Argument(help="Export tree that `verisim export` wrote.")],
        output: Annotated[Path, typer.Option("-o", "--output", help="Folder for the report.")],
        only: Annotated[
            str | None, typer.Option(help="Comma-separated parts, e.g. scores,agreement.")
        ] = None,
        source: Annotated[
            str | None,
            typer.Option(help="Answers to use: live, or one source, e.g. simulated, lab, link."),
        ] = None,
        force: Annotated[bool, typer.Option(help="Replace an existing report.")] = False,
    ) -> None:
        """Statistics, figures and report.html from exported tables alone.

        Refuses to mix simulated with live answers unless --source names one.
        """
        from verisim import analysis

        parts = None if only is None else [part.strip() for part in only.split(",")]
        result = analysis.analyse(export, output, source=source, only=parts, force=force)
        typer.echo(str(result.report))
