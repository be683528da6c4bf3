# SPDX-License-Identifier: MIT
"""`verisim simulate` and `verisim check`: run a scene, or say what is wrong with a file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from verisim.commands.design import design_problems, is_study, print_design
from verisim.commands.messages import fail, print_json, progress_bar, say

Sets = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=VALUE",
        help="Override a value, e.g. --set physics.dt_s=1e-4 or "
        "--set 'bodies.fox.position_m=[0,0,2]'. May be repeated.",
    ),
]
Scene = Annotated[Path, typer.Argument(help="Scene file (YAML).", show_default=False)]


def register(app: typer.Typer) -> None:
    @app.command()
    def simulate(
        scene: Scene,
        overrides: Sets = None,
        poses: Annotated[
            Path | None, typer.Option(metavar="FILE.npz", help="Write the pose log here.")
        ] = None,
        every: Annotated[
            float | None,
            typer.Option(min=1e-9, metavar="S", help="Sample every S seconds, not per frame."),
        ] = None,
        threads: Annotated[
            int, typer.Option(min=1, max=256, help="Threads; results do not depend on it.")
        ] = 1,
        as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
    ) -> None:
        """Run a scene without pictures and print its metrics.

        Exit status 1 when the run failed (exploded, sank, fell …); the metrics are printed all
        the same. With --json the object holds scene, steps, cost, metrics and final bodies.
        """
        from verisim import engine

        if poses is not None and poses.suffix != ".npz":
            fail(f"--poses {poses}: a pose log's name ends in .npz", code=2)
        with progress_bar(f"simulating {scene.stem}") as report:
            run = engine.simulate(
                scene,
                overrides or (),
                sample_interval_s=every,
                num_threads=threads,
                progress=report,
            )
        if poses is not None:
            run.poses.save(poses)
        if as_json:
            print_json(run.summary)
        else:
            _print(run.summary, run.parameters)
        if run.summary["failed"]:
            raise typer.Exit(1)

    @app.command()
    def check(
        file: Annotated[Path, typer.Argument(help="A scene, stimulus set, study or export tree.")],
        clips: Annotated[
            Path | None,
            typer.Option(help="Clips of a study, for its design. Default: out/stimuli/SET."),
        ] = None,
    ) -> None:
        """Say everything that is wrong with a scene, set, study or export, at once.

        Of a study whose clips are there, also prints the design: trials per participant, minutes,
        how often each clip is shown.
        """
        problems = _problems(file)
        if not problems and is_study(file):
            problems = design_problems(file, clips)
        if problems:
            for problem in problems:
                say(problem)
            fail(f"{file}: {len(problems)} problem{'s' if len(problems) > 1 else ''}")
        typer.echo(f"{file}: nothing wrong")
        if is_study(file):
            print_design(file, clips)


def _problems(file: Path) -> list[str]:
    """Every problem of a file, one text each; which checker depends on the keys it holds."""
    from verisim import engine

    if file.is_dir():
        from verisim.analysis.load import check_export

        return [str(problem) for problem in check_export(file)]
    try:
        text = file.read_text("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        return [f"{file}: cannot be read: {error}"]
    keys = {line.split(":")[0] for line in text.splitlines() if line[:1].isalpha()}
    if "questions" in keys or "consent" in keys:
        from verisim.study.server import check_study

        return [str(problem) for problem in check_study(file)]
    if "scenes" in keys:
        from verisim.stimuli import check_set

        return [str(problem) for problem in check_set(file)]
    try:
        engine.check_scene(file)
    except (engine.SceneError, engine.PoseLogError) as error:
        problems: list[str] = []
        for line in str(error).splitlines():
            if line.startswith("  ") and problems:
                problems[-1] += "\n" + line
            else:
                problems.append(line)
        return problems
    return []


def _print(summary: dict[str, Any], parameters: dict[str, Any]) -> None:
    metrics = summary["metrics"]
    typer.echo(f"{summary['scene']}: {summary['duration_s']:g} s, method {summary['method']}")
    typer.echo("chosen           " + ", ".join(f"{k} {_short(v)}" for k, v in parameters.items()))
    typer.echo(
        f"cost             {summary['cpu_s']:.3g} CPU s, {summary['steps']} steps of "
        f"{summary['dt_s']:.3g} s, {summary['cpu_s_per_sim_s'] or 0:.3g} CPU s per simulated s"
    )
    for key, value in metrics.items():
        typer.echo(f"{key:<26} {_short(value)}")
    for body in summary["bodies"]:
        at = ", ".join(f"{x:.4g}" for x in body["position_m"])
        typer.echo(f"{body['name']:<16} at {at} m")
    if summary["failed"]:
        failed = summary["failed"]
        typer.echo(f"FAILED: {failed['code']} at {failed['time_s']:.4g} s: {failed['message']}")


def _short(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
