# SPDX-License-Identifier: MIT
"""`verisim bench`: speed against accuracy, and where methods fail."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from verisim.commands.messages import fail, print_json, progress_bar, say


def register(app: typer.Typer) -> None:
    @app.command()
    def bench(
        output: Annotated[
            Path, typer.Option("-o", "--output", metavar="DIR", help="Folder to write.")
        ],
        scenes: Annotated[
            list[str] | None,
            typer.Argument(metavar="[SCENE]...", help="Bench scenes by name; default: all."),
        ] = None,
        stability: Annotated[
            bool, typer.Option("--stability", help="Maps of where each method fails instead.")
        ] = False,
        real_time: Annotated[
            bool,
            typer.Option(
                "--real-time", help="How many bodies run at 30 and 60 frames per second instead."
            ),
        ] = False,
        quick: Annotated[
            bool, typer.Option("--quick", help="Few settings and runs: some minutes.")
        ] = False,
        methods: Annotated[
            str | None,
            typer.Option(
                metavar="NAMES",
                help="Comma-separated, of seed, dem, dem-explicit and xpbd (maps: dem-hybrid); "
                "default: all.",
            ),
        ] = None,
        peers: Annotated[
            str | None,
            typer.Option(
                metavar="NAMES",
                help="Other engines beside ours: all, or comma-separated names; installs what is "
                "missing.",
            ),
        ] = None,
        maps: Annotated[
            str | None,
            typer.Option(metavar="NAMES", help="With --stability: comma-separated; default: all."),
        ] = None,
        jobs: Annotated[
            int | None,
            typer.Option(
                "-j",
                "--jobs",
                min=1,
                max=1024,
                help="With --stability: cells at once; default: cores. Charts run one by one.",
            ),
        ] = None,
        as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
    ) -> None:
        """Chart speed against accuracy: every method over a ladder of settings, scene by scene.

        Writes a table per scene with every run, figures and a page. A bench that was stopped goes
        on where it was; what did not change is not run again. With --stability: the maps of where
        methods fail, predictions first; prints the share of cells that did as predicted.
        """
        from verisim.bench.problems import BenchError

        for option, value, wanted in (
            ("SCENE", scenes, False),
            ("--real-time", real_time, False),
            ("--peers", peers, False),
            ("--maps", maps, True),
            ("--jobs", jobs, True),
        ):
            if value and stability != wanted:
                fail(
                    f"bench: {option} goes {'with' if wanted else 'without'} --stability\n"
                    "  hint: verisim bench --help lists what each of the two takes",
                    code=2,
                )
        try:
            if stability:
                _stability(output, quick, _names(maps), _names(methods), jobs, as_json)
            elif real_time:
                _real_time(output, quick, _names(methods), as_json)
            else:
                _chart(output, scenes, quick, _names(methods), _names(peers), as_json)
        except BenchError as error:
            fail(f"bench: {error}", code=2)


def _real_time(output: Path, quick: bool, methods: list[str] | None, as_json: bool) -> None:
    from verisim.bench.chart.page import body_words
    from verisim.bench.chart.real_time import run_real_time
    from verisim.bench.chart.run_chart import choose_ladders

    ladders = choose_ladders(methods)
    with progress_bar("methods") as report:
        result = run_real_time(output, ladders, quick=quick, progress=report, say=say)
    if as_json:
        print_json(
            {
                "directory": str(result.directory),
                "page": str(result.page),
                "piles": [asdict(crowd) for crowd in result.crowds],
                "answers": [asdict(answer) for answer in result.answers],
            }
        )
        return
    for answer in result.answers:
        typer.echo(
            f"{answer.method:<14} {answer.shape:<7} {answer.rate_hz:.0f} fps: "
            f"{body_words(answer.simulated)} simulated, {body_words(answer.at_rest)} at rest, "
            f"{body_words(answer.drawn_too)} simulated and drawn"
        )
    typer.echo(str(result.page))


def _chart(
    output: Path,
    scenes: list[str] | None,
    quick: bool,
    methods: list[str] | None,
    peers: list[str] | None,
    as_json: bool,
) -> None:
    from verisim.bench.chart import run_chart
    from verisim.bench.chart.front import front

    with progress_bar("runs", counts=True) as report:
        result = run_chart(
            output,
            scenes=scenes,
            methods=methods,
            peers=peers or (),
            quick=quick,
            progress=report,
            say=say,
        )
    found: list[dict[str, Any]] = []
    for chart in result.charts:
        measure = chart.scene.measures[0]
        found.extend(
            {
                "scene": chart.scene.key,
                "measure": measure.key,
                "method": point.method,
                "setting": point.setting,
                "error": point.error,
                "cpu_s_per_sim_s": point.cost,
            }
            for point in front(chart.points[measure.key])
        )
    if as_json:
        print_json(
            {
                "directory": str(result.directory),
                "page": str(result.page),
                "run": result.num_run,
                "kept": result.num_kept,
                "fronts": found,
            }
        )
        return
    for row in found:
        typer.echo(
            f"{row['scene']:<16} {row['method']:<18} {row['setting']:<28} "
            f"error {row['error']:<9.3g} {1e3 * row['cpu_s_per_sim_s']:.3g} ms CPU per s"
        )
    typer.echo(f"{result.page}: {result.num_run} runs made, {result.num_kept} kept")


def _stability(
    output: Path,
    quick: bool,
    maps: list[str] | None,
    methods: list[str] | None,
    jobs: int | None,
    as_json: bool,
) -> None:
    from verisim.bench.stability import run_stability
    from verisim.bench.stability.score import percent

    with progress_bar("cells", counts=True) as report:
        result = run_stability(
            output, quick=quick, maps=maps, methods=methods, jobs=jobs, progress=report, say=say
        )
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
