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
DUMP_S = 0.5  # of a failed run
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
        dump: Annotated[
            Path | None,
            typer.Option(
                metavar="FILE.npz",
                help="If the run fails, write poses and contacts of the half second before here.",
            ),
        ] = None,
        as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
    ) -> None:
        """Run a scene without pictures and print its metrics.

        Exit status 1 when the run failed (exploded, sank, fell …); the metrics are printed all
        the same. With --json the object holds scene, steps, cost, metrics, what the method chose,
        contact events and final bodies.
        """
        from verisim import engine

        for option, file in (("--poses", poses), ("--dump", dump)):
            if file is not None and file.suffix != ".npz":
                fail(f"{option} {file}: a pose log's name ends in .npz", code=2)
        with progress_bar(f"simulating {scene.stem}") as report:
            run = engine.simulate(
                scene,
                overrides or (),
                sample_interval_s=every,
                num_threads=threads,
                progress=report,
                keep_before_failure_s=0 if dump is None else DUMP_S,
            )
        if poses is not None:
            run.poses.save(poses)
        if dump is not None and run.last is not None:
            run.last.save(dump)
            say(f"{dump}: poses and contacts of the last {DUMP_S:g} s before the failure")
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
    typer.echo("parameters       " + ", ".join(f"{k} {_short(v)}" for k, v in parameters.items()))
    if summary["chosen"]:
        typer.echo("chosen           " + _chosen(summary["chosen"]))
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


def _chosen(chosen: dict[str, Any]) -> str:
    """What method dem made of the penetration that the scene allows; the steps of xpbd."""
    if "substep_s" in chosen:
        return (
            f"{chosen['substeps']} substeps of {chosen['substep_s']:.3g} s, no rebound below "
            f"{chosen['restitution_threshold_m_s']:.3g} m/s, steps from {chosen['dt_s']:.3g} s"
        )
    parts = [
        f"penetration {chosen['max_penetration_m']:.3g} m allowed",
        f"{chosen['rest_penetration_m']:.3g} m under a resting load",
        f"{chosen['predicted_penetration_m']:.3g} m predicted",
    ]
    if chosen["bound"]:
        parts.append(f"stiffness up to {chosen['stiffness']:.3g} N/m (bound: {chosen['bound']})")
    parts.append(f"steps from {chosen['dt_s']:.3g} s")
    return ", ".join(parts)


def _short(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
