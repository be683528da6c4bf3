# SPDX-License-Identifier: MIT
"""`verisim render` and `verisim view`: a scene as a clip, or in a window."""

from __future__ import annotations

import re
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from verisim.commands.messages import fail, progress_bar, say
from verisim.commands.physics import Scene, Sets


class Profile(StrEnum):
    stimulus = "stimulus"
    master = "master"
    preview = "preview"


class Backend(StrEnum):
    auto = "auto"
    egl = "egl"
    osmesa = "osmesa"


class Show(StrEnum):
    mesh = "mesh"
    particles = "particles"


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d{2,5})x(\d{2,5})", text)
    if match is None:
        fail(f"--size {text}: allowed: WIDTHxHEIGHT in pixels, e.g. 1280x720", code=2)
    return int(match[1]), int(match[2])


def register(app: typer.Typer) -> None:
    @app.command()
    def render(
        scene: Scene,
        output: Annotated[Path, typer.Option("-o", "--output", help="The clip to write (.mp4).")],
        overrides: Sets = None,
        poses: Annotated[
            Path | None,
            typer.Option(metavar="FILE.npz", help="Draw this pose log; nothing is simulated."),
        ] = None,
        size: Annotated[str, typer.Option(help="Width x height in pixels, even.")] = "1280x720",
        profile: Annotated[
            Profile,
            typer.Option(help="stimulus: near-lossless. master: lossless. preview: small."),
        ] = Profile.stimulus,
        gl: Annotated[
            Backend, typer.Option(help="OpenGL backend; auto tries EGL, then OSMesa.")
        ] = Backend.auto,
        show: Annotated[
            Show, typer.Option(help="The bodies' own meshes, or the particles that fill them.")
        ] = Show.mesh,
        force: Annotated[bool, typer.Option(help="Replace an existing clip.")] = False,
    ) -> None:
        """Simulate a scene and render it to a clip, with clip.json beside it saying how.

        Video frame i shows time i / frame_rate_hz. A run that fails still gives its clip.
        """
        from verisim.clip import make_clip
        from verisim.pose_log import PoseLog

        if output.suffix != ".mp4":
            fail(f"-o {output}: a clip's name ends in .mp4", code=2)
        if output.exists() and not force:
            fail(f"{output} exists\n  hint: --force replaces it")
        pose_log = None if poses is None else PoseLog.load(poses)
        with progress_bar(f"rendering {output.name}", counts=True) as report:
            sidecar = make_clip(
                scene,
                output,
                overrides=overrides or (),
                size=_size(size),
                profile=profile.value,
                gl=gl.value,
                show=show.value,
                poses=pose_log,
                progress=report,
            )
        if sidecar.get("failed"):
            say(f"the run failed: {sidecar['failed']['code']}: {sidecar['failed']['message']}")
        typer.echo(str(output))
