# SPDX-License-Identifier: MIT
"""`verisim stimuli`: the clips of a set, and what each setting costs to compute."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from verisim.commands.messages import print_json, progress_bar, say

app = typer.Typer(help="Build the clips of a stimulus set; measure their cost.")

SetFile = Annotated[Path, typer.Argument(help="Stimulus set (YAML).", show_default=False)]
Output = Annotated[
    Path | None,
    typer.Option(
        "-o", "--output", metavar="DIR", help="Folder to write; by default out/stimuli/NAME."
    ),
]
Json = Annotated[bool, typer.Option("--json", help="One JSON object.")]


@app.command()
def build(
    set_file: SetFile,
    output: Output = None,
    jobs: Annotated[
        int | None,
        typer.Option("-j", "--jobs", min=1, max=1024, help="Clips at once; default: cores."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Simulate and render every clip of a set, with manifest.csv.

    Clips that are there already and whose content did not change are kept; a build that was
    stopped goes on where it was. A run whose physics fails still gives its clip.
    """
    from verisim.stimuli import build_set

    folder = output or default_folder(set_file)
    with progress_bar("clips", counts=True) as report:
        result = build_set(set_file, folder, jobs, progress=report)
    for name, code in result.failed_runs.items():
        say(f"{name}: the physics failed ({code}); its clip shows it")
    if as_json:
        print_json(
            {
                "directory": str(folder),
                "built": result.built,
                "kept": result.kept,
                "failed_runs": result.failed_runs,
            }
        )
    else:
        typer.echo(f"{folder}: {len(result.built)} clips built, {len(result.kept)} kept")


@app.command()
def cost(
    set_file: SetFile,
    output: Output = None,
    repeats: Annotated[
        int, typer.Option(min=5, max=10_000, help="Counted runs of each stimulus.")
    ] = 5,
    max_minutes: Annotated[
        float | None,
        typer.Option(min=0, help="Leave out rounds after this time, never one of the first five."),
    ] = None,
) -> None:
    """Measure what each setting costs: physics alone, one thread, interleaved rounds.

    Writes cost.csv (CPU seconds per simulated second: median, min, quartiles) and cost_runs.csv.
    Leave the machine alone meanwhile.
    """
    from verisim.stimuli import measure_cost

    folder = output or default_folder(set_file)
    with progress_bar("runs", counts=True) as report:
        file = measure_cost(set_file, folder, repeats, max_minutes, progress=report)
    typer.echo(str(file))


def default_folder(set_file: Path) -> Path:
    """out/stimuli/NAME under the current folder, NAME as the set says. Raises SetError."""
    from verisim.stimuli import load_set

    return Path("out/stimuli") / load_set(set_file).name
