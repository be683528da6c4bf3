# SPDX-License-Identifier: MIT
"""`verisim tune`: the cheapest setting that will do."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from verisim.commands.messages import fail, print_json, progress_bar

if TYPE_CHECKING:
    from verisim.bench.chart.tune import Candidate, Tuned

UNITS = {"error_m": "m", "penetration_m": "m", "overlap_px": "px", "frame_s": "s a frame"}


def register(app: typer.Typer) -> None:
    @app.command()
    def tune(
        scene: Annotated[Path, typer.Argument(help="Scene file (YAML).", show_default=False)],
        max_error_m: Annotated[
            float | None,
            typer.Option(
                min=0, metavar="M", help="Rms distance from the scene's finest run, at most."
            ),
        ] = None,
        max_penetration_m: Annotated[
            float | None, typer.Option(min=0, metavar="M", help="Deepest overlap, at most.")
        ] = None,
        max_overlap_px: Annotated[
            float | None,
            typer.Option(
                min=0,
                metavar="PX",
                help="The same in pixels of a frame of 720 rows, seen by the scene's camera.",
            ),
        ] = None,
        real_time: Annotated[
            float | None,
            typer.Option(
                min=1,
                max=1000,
                metavar="FPS",
                help="The finest setting of which 95 of 100 frames take no longer than 1/FPS here.",
            ),
        ] = None,
        methods: Annotated[
            str | None,
            typer.Option(metavar="NAMES", help="Comma-separated; default: the scene's method."),
        ] = None,
        dry_run: Annotated[
            bool, typer.Option("--dry-run", help="Leave the scene file as it is.")
        ] = False,
        as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
    ) -> None:
        """Choose the cheapest setting that meets a bound and write it into the scene.

        Runs a ladder of settings on the scene itself, shows the front it chooses from, runs the
        chosen setting once more and writes it into the scene's physics block; comments stay.
        Exit status 1 if no setting meets the bound: the file is left as it is.
        """
        from verisim.bench.chart import tune as tuning
        from verisim.bench.chart.write_physics import write_physics
        from verisim.bench.problems import BenchError

        asked = {
            "error_m": max_error_m,
            "penetration_m": max_penetration_m,
            "overlap_px": max_overlap_px,
            "frame_s": None if real_time is None else 1 / real_time,
        }
        bounds = [(kind, value) for kind, value in asked.items() if value is not None]
        if len(bounds) != 1:
            fail(
                f"tune: {len(bounds) or 'no'} bounds named; allowed: exactly one of --max-error-m, "
                "--max-penetration-m, --max-overlap-px, --real-time\n"
                "  hint: --max-overlap-px 0.5 asks for what a viewer could not see",
                code=2,
            )
        bound = tuning.Bound(*bounds[0])
        try:
            with progress_bar("settings", counts=True) as report:
                names = None if methods is None else [name.strip() for name in methods.split(",")]
                found = tuning.tune(scene, bound, methods=names, progress=report)
        except BenchError as error:
            fail(f"tune: {error}", code=2)
        writes = found.chosen is not None and found.holds and not dry_run
        if writes and found.chosen is not None:
            write_physics(scene, found.chosen.overrides)
        if as_json:
            print_json(_as_json(found, wrote=writes))
        else:
            _print(found, wrote=writes)
        if not found.holds:
            raise typer.Exit(1)


def _print(found: Tuned, *, wrote: bool) -> None:
    kind = found.bound.kind
    shown = ["error_m", "frame_s"] if kind == "frame_s" else [kind]
    header = "  ".join(f"{name:>14}" for name in shown)
    typer.echo(f"{'':2}{'method':<14}{'setting':<32}{'ms CPU per s':>12}  {header}")
    for each in found.front():
        mark = "*" if each is found.chosen else " "
        values = "  ".join(f"{each.values[name]:>14.3g}" for name in shown)
        typer.echo(f"{mark:2}{each.method:<14}{each.setting:<32}{1e3 * each.cost:>12.3g}  {values}")
    if found.reference:
        typer.echo(f"errors are against {found.reference}")
    failed = [each for each in found.candidates if each.failed]
    if failed:
        words = "; ".join(f"{each.setting}: {each.failed}" for each in failed)
        typer.echo(f"failed: {words}")
    if found.chosen is None or found.again is None:
        best = min(
            (c.values.get(kind, math.inf) for c in found.candidates if not c.failed), default=0
        )
        typer.echo(
            f"no setting meets {kind} <= {found.bound.most:.3g}; the least found is {best:.3g}. "
            "The scene is left as it is."
        )
        return
    typer.echo(
        f"chosen (*): {found.chosen.method}, {found.chosen.setting}; run once more: "
        f"{found.again.values[kind]:.3g} {UNITS[kind]} of {found.bound.most:.3g} allowed, "
        f"{1e3 * found.again.cost:.3g} ms CPU per s: bound {'met' if found.holds else 'NOT MET'}"
    )
    typer.echo(f"{found.scene}: {'physics written' if wrote else 'left as it is'}")


def _as_json(found: Tuned, *, wrote: bool) -> dict[str, Any]:
    def row(each: Candidate | None) -> dict[str, Any] | None:
        if each is None:
            return None
        return {
            "method": each.method,
            "setting": each.setting,
            "overrides": each.overrides,
            "cpu_s_per_sim_s": each.cost,
            "failed": each.failed or None,
            **each.values,
        }

    return {
        "scene": str(found.scene),
        "bound": {"kind": found.bound.kind, "most": found.bound.most},
        "reference": found.reference or None,
        "front": [row(each) for each in found.front()],
        "candidates": [row(each) for each in found.candidates],
        "chosen": row(found.chosen),
        "run_again": row(found.again),
        "met": found.holds,
        "written": wrote,
    }
