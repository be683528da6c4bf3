# SPDX-License-Identifier: MIT
"""`verisim view`: a scene, or a recorded run of it, in a window."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from verisim.commands.messages import fail
from verisim.commands.physics import Scene, Sets
from verisim.commands.pictures import Show


def register(app: typer.Typer) -> None:
    @app.command()
    def view(
        scene: Scene,
        overrides: Sets = None,
        poses: Annotated[
            Path | None,
            typer.Option(metavar="FILE.npz", help="Scrub this pose log; nothing is simulated."),
        ] = None,
        show: Annotated[
            Show, typer.Option(help="The bodies' own meshes, or the particles that fill them.")
        ] = Show.mesh,
        screenshot: Annotated[
            Path | None,
            typer.Option(
                metavar="FILE.png",
                help="Write a picture of the window and close; for tests and documents.",
            ),
        ] = None,
        after: Annotated[
            float, typer.Option(min=0, metavar="S", help="The scene's time in that picture, s.")
        ] = 1.0,
    ) -> None:
        """Run a scene in a window: look around, pull bodies, change its physics.

        H shows keys and mouse. What was changed is shown as --set options and can be saved as a
        scene. Needs a display (X11 or Wayland); `verisim render` does not.
        """
        from verisim import _engine, engine

        if screenshot is not None and screenshot.suffix != ".png":
            fail(f"--screenshot {screenshot}: a picture's name ends in .png", code=2)
        if not hasattr(_engine, "view_scene"):
            fail("this build has no viewer\n  hint: build with -DVERISIM_VIEW=ON")
        loaded = engine.load_scene(scene, overrides or ())
        engine.require_particles(loaded, show.value)
        log = None if poses is None else engine.PoseLog.load(poses)
        if log is not None and log.names != loaded.body_names:
            fail(
                f"{poses}: the log's bodies are {', '.join(log.names)}; "
                f"the scene's are {', '.join(loaded.body_names)}"
            )
        _engine.view_scene(
            loaded,
            overrides or [],
            show.value,
            None if screenshot is None else str(screenshot),
            after,
            None if log is None else log.time_s,
            None if log is None else log.position_m,
            None if log is None else log.orientation_wxyz,
        )
