# SPDX-License-Identifier: MIT
"""`verisim study …` and `verisim export`: show clips to people and hand out their answers."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from verisim.commands.messages import progress_bar, say

app = typer.Typer(help="Run a study: people rate clips in a browser.", no_args_is_help=True)

StudyFile = Annotated[Path, typer.Argument(help="Study file (YAML).", show_default=False)]
Clips = Annotated[
    Path | None,
    typer.Option(
        "--clips",
        "--stimuli",
        help="Folder that `verisim stimuli build` made. Default: out/stimuli/SET.",
    ),
]
Database = Annotated[
    str | None,
    typer.Option(
        help="SQLite file with the answers, or postgresql://USER@HOST/NAME. Default: out/NAME.db."
    ),
]
Port = Annotated[int, typer.Option(min=0, max=65535)]


def _places(study_file: Path, clips: Path | None, db: str | None) -> tuple[Path, str]:
    from verisim.study.server.study_file import load_study

    study = load_study(study_file)
    return clips or Path("out/stimuli") / study.set, db or f"out/{study.name}.db"


@app.command()
def serve(
    study_file: StudyFile,
    clips: Clips = None,
    db: Database = None,
    port: Port = 8000,
    host: Annotated[
        str,
        typer.Option(
            help="Address to listen on. Anything but 127.0.0.1 lets other machines reach the "
            "participants' page, unencrypted: put a reverse proxy with TLS in front."
        ),
    ] = "127.0.0.1",
    live: Annotated[
        bool, typer.Option("--live", help="Collect real data: the study must be as it was frozen.")
    ] = False,
    pilot: Annotated[
        bool, typer.Option("--pilot", help="Try the study out: everybody is marked as a pilot.")
    ] = False,
    kiosk: Annotated[
        bool,
        typer.Option(
            "--kiosk", help="One machine in a lab: opens Chromium in full screen; N for the next."
        ),
    ] = False,
    admin_port: Annotated[
        int | None,
        typer.Option(min=0, max=65535, help="Port of the administration page, this machine only."),
    ] = None,
) -> None:
    """Serve a study to participants until Ctrl-C; answers go to the database at once."""
    from verisim.study.problems import refuse
    from verisim.study.server import serve as serve_study
    from verisim.study.server.database import read_place
    from verisim.study.server.kiosk import open_kiosk

    if live and pilot:
        raise refuse("serve", "--live and --pilot exclude each other", "give one of them")
    set_dir, place = _places(study_file, clips, db)
    mode = "live" if live else "pilot" if pilot else "open"

    def ready(url: str) -> None:
        say(f"participants: {url}\nanswers: {read_place(place)}\nmode: {mode}; Ctrl-C ends.")
        if kiosk:
            open_kiosk(url)

    serve_study(
        study_file,
        set_dir,
        read_place(place),
        host,
        port,
        source_default="lab" if kiosk else "link",
        mode=mode,
        kiosk=kiosk,
        admin_port=admin_port,
        on_ready=ready,
        on_admin=lambda url: say(f"administration: {url}"),
    )
    say(f"closed; export with: verisim export --db {read_place(place)} -o out/export")


@app.command()
def simulate(
    study_file: StudyFile,
    participants: Annotated[int, typer.Option(min=1, help="Number of scripted raters.")],
    clips: Clips = None,
    db: Database = None,
    seed: Annotated[int, typer.Option(help="Of the raters' noise.")] = 1,
    bias: Annotated[float, typer.Option(help="Added to every judgement.")] = 0.0,
    noise: Annotated[float, typer.Option(min=0, help="SD of a judgement, 0 to 1 scale.")] = 0.1,
    lapse: Annotated[float, typer.Option(min=0, max=1, help="Share of random answers.")] = 0.02,
    side_bias: Annotated[float, typer.Option(help="Towards the second or right clip.")] = 0.0,
    false_alarm: Annotated[
        float, typer.Option(min=0, max=1, help="Share of flawless clips found wrong.")
    ] = 0.05,
    spread: Annotated[float, typer.Option(min=0, help="Of traits between raters; 0: none.")] = 1.0,
    threshold: Annotated[
        list[str] | None,
        typer.Option(help="TRACK=MAGNITUDE at which half of the clips are noticed; repeatable."),
    ] = None,
    browser: Annotated[
        bool,
        typer.Option(
            "--browser",
            help="Let them sit at the real page in Chromium, each in real time. Ended early, the "
            "same command goes on.",
        ),
    ] = False,
) -> None:
    """Let scripted raters answer through the real HTTP interface; marked source=simulated.

    They see only what each clip achieved: its visible error, and on adaptive tracks the size of the
    manipulation, never a level's name or a clip's cost.
    """
    from verisim.study.server import simulate as simulate_study
    from verisim.study.server import simulate_in_browser
    from verisim.study.server.database import read_place
    from verisim.study.server.observer import Traits, read_thresholds

    set_dir, place = _places(study_file, clips, db)
    traits = Traits(
        bias=bias,
        noise=noise,
        lapse=lapse,
        side_bias=side_bias,
        false_alarm=false_alarm,
        spread=spread,
        thresholds=read_thresholds(threshold or []),
    )
    where = read_place(place)
    with progress_bar("forms" if browser else "raters", counts=True) as report:
        rate: Callable[..., object] = simulate_study
        if browser:
            rate = partial(
                simulate_in_browser,
                on_visit=lambda visit: say(
                    f"rater {visit.rater + 1}: {visit.num_forms} forms in {visit.took_s:.0f} s"
                ),
            )
        rate(study_file, set_dir, where, participants, seed, traits=traits, on_progress=report)
    say(f"answers: {read_place(place)}")


@app.command()
def freeze(
    study_file: StudyFile,
    clips: Clips = None,
    protocol: Annotated[
        Path | None, typer.Option(help="The registered protocol; fixed with the study.")
    ] = None,
    again: Annotated[
        str | None, typer.Option(metavar="REASON", help="Freeze a changed study again, and why.")
    ] = None,
) -> None:
    """Fix a study before its first participant: hashes of study, texts, rules, clips, protocol.

    Writes STUDY.frozen.json. `serve --live` refuses anything else and logs every deviation.
    """
    from verisim.study.server.freezing import freeze as freeze_study

    set_dir, _ = _places(study_file, clips, None)
    typer.echo(str(freeze_study(study_file, set_dir, protocol, reason=again)))


@app.command()
def backup(
    study_file: StudyFile,
    db: Annotated[Path | None, typer.Option(help="SQLite file. Default: out/NAME.db.")] = None,
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for the copies.")] = Path(
        "out/backup"
    ),
    keep_days: Annotated[
        int | None, typer.Option(min=1, help="Delete copies that are older.")
    ] = None,
) -> None:
    """Copy the database, also while the server runs, and check that the copy is whole."""
    from verisim.study.server.backup import back_up

    _, place = _places(study_file, None, str(db) if db else None)
    typer.echo(str(back_up(Path(place), output, keep_days)))


@app.command()
def verify(db: Annotated[Path, typer.Option(help="SQLite file of a study.")]) -> None:
    """Check that a database or a backup is whole."""
    from verisim.commands.messages import fail
    from verisim.study.server.backup import find_damage

    problems = find_damage(db)
    for problem in problems:
        say(problem)
    if problems:
        fail(f"{db}: damaged")
    typer.echo(f"{db}: whole")


@app.command()
def links(
    study_file: StudyFile,
    num: Annotated[int, typer.Option(min=1, max=100_000, help="How many to make.")] = 1,
    label: Annotated[str, typer.Option(help="What the list calls them.")] = "link",
    source: Annotated[str, typer.Option(help="lab | link | pilot")] = "link",
    uses: Annotated[int, typer.Option(min=0, help="Times each can be used; 0: any.")] = 1,
    address: Annotated[
        str, typer.Option(help="Where participants reach the page.")
    ] = "http://127.0.0.1:8000",
    close: Annotated[bool, typer.Option("--close", help="Close the links of this label.")] = False,
    clips: Clips = None,
    db: Database = None,
) -> None:
    """Make participant links (CSV: label,link), or close those of a label."""
    from verisim.study.problems import refuse
    from verisim.study.server.database import read_place
    from verisim.study.server.links import close_links, make_links
    from verisim.study.server.researcher import at_work_on

    if source not in ("lab", "link", "pilot"):
        raise refuse("source", f"{source!r} is not allowed", "give lab, link or pilot")
    set_dir, place = _places(study_file, clips, db)
    with at_work_on(study_file, set_dir, read_place(place)) as connection:
        if close:
            typer.echo(f"{close_links(connection, label)} links closed")
            return
        made = make_links(connection, num, label, source, uses or None)
    typer.echo("label,link")
    for link in made:
        typer.echo(f'"{link.label}",{link.address(address)}')


@app.command()
def erase(
    participant: Annotated[str, typer.Argument(help="Code, participant_id or outside id.")],
    db: Annotated[str, typer.Option(help="Database of the study.")],
    reason: Annotated[str, typer.Option(help="Kept in the record; name nobody.")] = "asked for",
) -> None:
    """Delete everything of one participant; stop the server first, or use its admin page."""
    from verisim.study.server import erase_participant
    from verisim.study.server.database import read_place

    num = erase_participant(read_place(db), participant, reason)
    typer.echo(f"deleted, {num} answers with it; older backups still hold them")


@app.command("forget-ids")
def forget_ids(db: Annotated[str, typer.Option(help="Database of the study.")]) -> None:
    """Delete every identifier of recruiting platforms, e.g. when everybody is paid."""
    from verisim.study.server.database import read_place
    from verisim.study.server.erasure import forget_outside_ids

    typer.echo(f"{forget_outside_ids(read_place(db))} outside identifiers deleted")


@app.command("admin-password")
def admin_password(
    name: Annotated[str, typer.Argument(help="Account; made if it is new.")],
    study_file: Annotated[Path, typer.Option("--study", help="Study file (YAML).")],
    clips: Clips = None,
    db: Database = None,
) -> None:
    """Set a password for the administration page (read from the terminal, or a pipe)."""
    from verisim.study.server.admin.login import set_password
    from verisim.study.server.database import read_place
    from verisim.study.server.researcher import at_work_on

    set_dir, place = _places(study_file, clips, db)
    password = typer.prompt("Password", hide_input=True, confirmation_prompt=True)
    with at_work_on(study_file, set_dir, read_place(place)) as connection:
        set_password(connection, name, password)
    say(f"password of {name} set")


def register_export(root: typer.Typer) -> None:
    @root.command()
    def export(
        db: Annotated[str, typer.Option(help="Database of a study: file or postgresql://…")],
        output: Annotated[Path, typer.Option("-o", "--output", help="Folder for the tables.")],
        blind: Annotated[
            bool, typer.Option(help="Leave out which scene and setting a clip is.")
        ] = False,
        force: Annotated[bool, typer.Option(help="Replace an existing export.")] = False,
    ) -> None:
        """Write tidy tables with a codebook (Psych-DS) from a study's database."""
        from verisim.study.export import export as export_study
        from verisim.study.server.database import read_place

        export_study(read_place(db), output, blind=blind, force=force)
        typer.echo(str(output))
