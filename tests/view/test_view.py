# SPDX-License-Identifier: MIT
"""The viewer in a real window: Xvfb is the screen, pictures of the window are the evidence."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import matplotlib.image
import numpy as np
import numpy.typing as npt
import pytest

from verisim import engine

Picture = npt.NDArray[np.float32]

PANEL_WIDTH_PX = 348
SCENE = """
schema: 1
name: ball_and_box
duration_s: 1
frame_rate_hz: 60
materials:
  wood: {density_kg_m3: 500}
bodies:
  - {name: ball, shape: {sphere_radius_m: 0.12}, material: wood, position_m: [-0.3, 0, 0.9]}
  - {name: box, shape: {box_m: [0.3, 0.3, 0.3]}, material: wood, position_m: [0.3, 0, 0.16]}
ground: {plane: {normal: [0, 0, 1], offset_m: 0}, material: wood}
physics: {method: seed, stiffness_n_m: 1.0e+4}
camera: {position_m: [0, -3, 0.8], look_at_m: [0, 0, 0.45], fov_deg: 34}
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    file = tmp_path / "ball_and_box.yaml"
    file.write_text(SCENE)
    return file


def run_view(*arguments: str | Path, display: bool = True) -> subprocess.CompletedProcess[str]:
    screen = ["xvfb-run", "-a"] if display else []
    hidden = {"DISPLAY", "WAYLAND_DISPLAY"}
    return subprocess.run(
        [*screen, sys.executable, "-m", "verisim", "view", *map(str, arguments)],
        env={key: value for key, value in os.environ.items() if key not in hidden},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


def picture_of(scene: Path, *arguments: str | Path) -> Picture:
    file = scene.parent / f"window_{len(list(scene.parent.iterdir()))}.png"
    result = run_view(scene, *arguments, "--screenshot", file)
    assert result.returncode == 0, result.stderr
    picture: Picture = matplotlib.image.imread(file)[:, :, :3]
    assert picture.shape == (720, 1280, 3)
    return picture


def scene_part(picture: Picture) -> Picture:
    return picture[:, :-PANEL_WIDTH_PX]


def num_orange(picture: Picture) -> int:
    """Pixels in the first body's colour, whatever the light on it."""
    red, green, blue = np.moveaxis(scene_part(picture), 2, 0)
    return int(np.count_nonzero((red > 1.5 * green) & (green > 1.2 * blue)))


def num_blue(picture: Picture) -> int:
    """Pixels in the second body's colour."""
    red, green, blue = np.moveaxis(scene_part(picture), 2, 0)
    return int(np.count_nonzero((blue > 1.8 * red) & (blue > 1.15 * green)))


def num_changed(before: Picture, after: Picture) -> int:
    change = np.abs(scene_part(before) - scene_part(after)).max(axis=2)
    return int(np.count_nonzero(change > 0.05))


def test_the_window_shows_bodies_and_panel(scene: Path) -> None:
    picture = picture_of(scene, "--after", "0.1")
    # Measured: 7 089 orange and 17 317 blue of 671 040 pixels, 1 605 colours.
    assert num_orange(picture) > 3000
    assert num_blue(picture) > 8000
    assert len(np.unique((scene_part(picture) * 255).reshape(-1, 3), axis=0)) > 500
    panel = picture[:, -PANEL_WIDTH_PX:]
    assert np.median(panel) < 0.2  # dark ground, measured 0.13
    assert np.count_nonzero(panel.min(axis=2) > 0.7) > 500  # light letters, measured 1 977


def test_the_particle_view_differs_from_the_surfaces(scene: Path) -> None:
    surfaces = picture_of(scene, "--after", "0")
    particles = picture_of(scene, "--after", "0", "--show", "particles")
    assert num_changed(surfaces, particles) > 2000  # measured 14 805
    assert num_blue(particles) > 8000  # measured 15 005


def test_dem_has_a_panel_of_its_own(scene: Path) -> None:
    seed = picture_of(scene, "--after", "0.1")
    dem = picture_of(scene, "--after", "0.1", "--set", "physics={}")
    assert num_orange(dem) > 3000
    assert num_blue(dem) > 8000
    change = np.abs(seed[:, -PANEL_WIDTH_PX:] - dem[:, -PANEL_WIDTH_PX:]).max(axis=2)
    assert np.count_nonzero(change > 0.05) > 2000  # measured 41 146


def test_an_override_reaches_the_window(scene: Path) -> None:
    """Without gravity the ball stays up; with it, it has fallen 0.2 m."""
    fallen = picture_of(scene, "--after", "0.2")
    floating = picture_of(scene, "--after", "0.2", "--set", "gravity_m_s2=[0,0,0]")
    assert num_changed(fallen, floating) > 2000  # measured 19 857


def test_a_pose_log_is_shown_at_the_time_asked_for(scene: Path, tmp_path: Path) -> None:
    log = tmp_path / "run.npz"
    engine.simulate(scene).poses.save(log)
    early = picture_of(scene, "--poses", log, "--after", "0")
    again = picture_of(scene, "--poses", log, "--after", "0")
    late = picture_of(scene, "--poses", log, "--after", "0.2")
    time_line_px = 80
    assert num_changed(early[:-time_line_px], again[:-time_line_px]) == 0
    assert num_changed(early[:-time_line_px], late[:-time_line_px]) > 2000


def test_a_pose_log_of_other_bodies_is_refused(scene: Path, tmp_path: Path) -> None:
    log = tmp_path / "run.npz"
    engine.simulate(scene, ["duration_s=0.05"]).poses.save(log)
    scene.write_text(SCENE.replace("name: ball,", "name: globe,"))
    result = run_view(scene, "--poses", log, display=False)
    assert result.returncode == 1
    assert "ball, box" in result.stderr
    assert "globe, box" in result.stderr


def test_without_a_display_the_error_says_what_is_needed(scene: Path) -> None:
    result = run_view(scene, display=False)
    assert result.returncode == 1
    assert "needs a display (X11 or Wayland)" in result.stderr
    assert "`verisim render` needs no display" in result.stderr
    assert "Traceback" not in result.stderr


def test_a_screenshot_that_cannot_be_written_is_named(scene: Path, tmp_path: Path) -> None:
    file = tmp_path / "no_such_folder" / "window.png"
    result = run_view(scene, "--after", "0", "--screenshot", file)
    assert result.returncode == 1
    assert str(file) in result.stderr
    assert run_view(scene, "--screenshot", "window.jpg", display=False).returncode == 2
