# SPDX-License-Identifier: MIT
"""`verisim bench`: where methods fail."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from verisim.commands.messages import fail, print_json, progress_bar, say


def register(app: typer.Typer) -> None:
    @app.command()
    def bench(
        output: Annotated[
            Path, typer.Option("-o", "--output", metavar="DIR", help="Folder to write.")
        ],
        stability: Annotated[
            bool, typer.Option("--stability", help="Maps of where each method fails.")
        ] = False,
        quick: Annotated[bool, typer.Option("--quick", help="Coarse grids, some minutes.")] = False,
        maps: Annotated[
            str | None, typer.Option(metavar="NAMES", help="Comma-separated maps; default: all.")
        ] = None,
        methods: Annotated[
            str | None,
            typer.Option(
                metavar="NAMES",
                help="Comma-separated, of seed, dem-explicit, dem-hybrid and xpbd; default: all.",
            ),
        ] = None,
        jobs: Annotated[
            int | None,
            typer.Option("-j", "--jobs", min=1, max=1024, help="Cells at once; default: cores."),
        ] = None,
        as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
    ) -> None:
        """Run the stability maps: predictions first, then every cell, figures and a page.

        A bench that was stopped goes on where it was; a cell whose scene and engine did not change
        is not run again. Prints the share of cells that did as predicted.
        """
        from verisim.bench.stability import BenchError, run_stability
        from verisim.bench.stability.score import percent

        if not stability:
            fail(
                "bench: nothing named to run\n"
                "  hint: add --stability for the maps of where methods fail",
                code=2,
            )
        try:
            with progress_bar("cells", counts=True) as report:
                result = run_stability(
                    output,
                    quick=quick,
                    maps=_names(maps),
                    methods=_names(methods),
                    jobs=jobs,
                    progress=report,
                    say=say,
                )
        except BenchError as error:
            fail(f"bench: {error}", code=2)
        total = result.scores[-1]
        if as_json:
            print_json(
                {
                    "directory": str(result.directory),
                    "page": str(result.page),
                    "run": result.num_run,
                    "kept": result.num_kept,
                    "predictions_changed_after_run": result.num_late,
                    "scores": [asdict(score) for score in result.scores],
                }
            )
            return
        for score in result.scores:
            typer.echo(
                f"{score.map:<15} {score.method:<13} {score.right:>5} of {score.cells:>5} "
                f"{percent(score.right, score.cells):>8}  beside a border "
                f"{percent(score.near_right, score.near):>8}  trivial "
                f"{percent(score.trivial, score.cells):>8}"
            )
        typer.echo(
            f"{result.page}: {result.num_run} cells run, {result.num_kept} kept, "
            f"{percent(total.right, total.cells)} as predicted"
        )


def _names(text: str | None) -> list[str] | None:
    return None if text is None else [name.strip() for name in text.split(",")]
