# SPDX-License-Identifier: MIT
"""`verisim shape`: what the engine makes of a mesh."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from verisim.commands.messages import print_json


def register(app: typer.Typer) -> None:
    @app.command()
    def shape(
        mesh: Annotated[Path, typer.Argument(help="OBJ, PLY, STL or glTF file.")],
        particle_size_m: Annotated[
            float | None,
            typer.Option(min=0, help="Particle diameter, m. Default: a quarter of the extent."),
        ] = None,
        as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
    ) -> None:
        """What the engine makes of a mesh: closed or not, volume, inertia, particles.

        Exit status 1 when the mesh cannot be simulated; the report says why.
        """
        from verisim import engine

        report = engine.inspect_shape(mesh, particle_size_m)
        if as_json:
            print_json(report)
        else:
            _print(mesh, report)
        if report["problems"]:
            raise typer.Exit(1)


def _print(mesh: Path, report: dict[str, Any]) -> None:
    typer.echo(f"{mesh}: {report['num_triangles']} triangles, ", nl=False)
    typer.echo("closed" if report["closed"] else "not closed")
    if report["volume_m3"] is not None:
        typer.echo(f"volume           {report['volume_m3']:.6g} m3")
        com = ", ".join(f"{x:.6g}" for x in report["center_of_mass_m"])
        typer.echo(f"centre of mass   {com} m")
        for i, row in enumerate(report["inertia_m5"]):
            words = "inertia, density 1" if i == 0 else " " * 18
            typer.echo(f"{words} " + "  ".join(f"{x: .6e}" for x in row) + " m5")
    if report["num_particles"] is not None:
        typer.echo(f"particles        {report['num_particles']}")
    for problem in report["problems"]:
        typer.echo(f"problem: {problem}")
