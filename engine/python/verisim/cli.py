# SPDX-License-Identifier: MIT
"""The verisim command: one Typer application, a file per group of commands."""

from __future__ import annotations

import sys

import typer

from verisim import __version__
from verisim.commands import (
    analysis,
    bench,
    demo,
    physics,
    pictures,
    shape,
    stimuli,
    study,
    tune,
    view,
)
from verisim.commands.messages import fail, is_user_error

app = typer.Typer(
    name="verisim",
    help="Perceptual studies of simulated physics: simulate, render, show, rate, analyse.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(__version__)
        raise typer.Exit


@app.callback()
def _root(
    version: bool = typer.Option(
        False, "--version", callback=_print_version, is_eager=True, help="Print the version."
    ),
) -> None:
    """Perceptual studies of simulated physics: simulate, render, show, rate, analyse."""
    del version


demo.register(app)
shape.register(app)
physics.register(app)
pictures.register(app)
view.register(app)
app.add_typer(stimuli.app, name="stimuli")
app.add_typer(study.app, name="study")
study.register_export(app)
analysis.register(app)
bench.register(app)
tune.register(app)


def main() -> None:
    """Runs the command; a problem the user can mend is one message and exit 1."""
    try:
        app(prog_name="verisim")
    except KeyboardInterrupt:
        sys.exit(130)
    except Exception as error:
        if not is_user_error(error):
            raise
        fail(str(error))
