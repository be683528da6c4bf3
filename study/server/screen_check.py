# SPDX-License-Identifier: MIT
"""Whether a screen can show a study's clips: what is wrong, and whether it can be mended."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from verisim.study.server.bodies import ScreenBody
from verisim.study.server.stimulus_set import Stimulus
from verisim.study.server.study_parts import ScreenRules, degrees_to_px

# A measured refresh rate is off by about 1 %; rates of real screens differ by 4 % at least
# (e.g. 144 Hz is no multiple of 60 Hz: 2.4).
REFRESH_TOLERANCE = 0.03


@dataclass(frozen=True)
class ScreenResult:
    verdict: str  # passed | flagged | refused
    problems: list[dict[str, Any]]
    px_per_degree: float | None
    ends_session: bool


def check_screen(
    rules: ScreenRules, stimuli: Sequence[Stimulus], across: int, body: ScreenBody
) -> ScreenResult:
    """Returns what is wrong. across: clips that stand beside each other, 1 or 2."""
    problems: list[dict[str, Any]] = []
    flagged = False

    def complain(code: str, message: str, *, fixable: bool) -> None:
        problems.append({"code": code, "fixable": fixable, "message": message})

    env = body.environment
    if rules.phone == "refuse" and env.is_mobile:
        complain("phone", "phones and tablets cannot take part", fixable=False)
    need = needed_viewport(rules, stimuli, across, env.device_pixel_ratio)
    if env.viewport_w < need[0] or env.viewport_h < need[1]:
        seen = f"{env.viewport_w} x {env.viewport_h}"
        complain(
            "viewport", f"the window has {seen} px, needed: {need[0]} x {need[1]}", fixable=True
        )
    rates = sorted({s.frame_rate_hz for s in stimuli})
    if rules.refresh != "ignore" and not all(fits(body.refresh_hz, rate) for rate in rates):
        seen = "unknown" if body.refresh_hz is None else f"{body.refresh_hz:g} Hz"
        message = f"the refresh rate ({seen}) is no multiple of {rates[-1]:g} Hz"
        if rules.refresh == "refuse":
            complain("refresh", message, fixable=False)
        else:
            flagged = True
            problems.append({"code": "refresh", "fixable": False, "message": message})
    if rules.codec and body.codec_plays is False:
        complain("codec", "this browser cannot play the clips", fixable=False)
    if rules.fullscreen == "require" and not body.fullscreen:
        complain("fullscreen", "the page must fill the screen", fixable=True)
    if rules.calibration == "require" and body.css_px_per_mm is None:
        complain("calibration", "the size of the screen was not measured", fixable=True)
    density = None
    if rules.distance_mm is not None:
        low, _, high = rules.distance_mm
        if body.viewing_distance_mm is None:
            complain("distance", "the viewing distance is missing", fixable=True)
        elif not low <= body.viewing_distance_mm <= high:
            complain("distance", f"sit {low:g} to {high:g} mm from the screen", fixable=True)
    if body.css_px_per_mm is not None and body.viewing_distance_mm is not None:
        density = degrees_to_px(
            body.css_px_per_mm, env.device_pixel_ratio, body.viewing_distance_mm
        )
    if rules.px_per_degree is not None and density is not None:
        low, high = rules.px_per_degree
        if not low <= density <= high:
            where = "nearer to" if density > high else "further from"
            complain("px_per_degree", f"please sit {where} the screen", fixable=True)
    refused = [p for p in problems if not (flagged and p["code"] == "refresh")]
    verdict = "refused" if refused else "flagged" if flagged else "passed"
    return ScreenResult(
        verdict, problems, density, any(not problem["fixable"] for problem in refused)
    )


def needed_viewport(
    rules: ScreenRules, stimuli: Sequence[Stimulus], across: int, device_pixel_ratio: float
) -> tuple[int, int]:
    """Returns the least window in CSS px: a device pixel per pixel of the largest clips, or what
    the study file asks for where that is more. The page computes the same."""
    asked = rules.min_viewport_px or [0, 0]
    width, height = (
        max(least, math.ceil(px / device_pixel_ratio))
        for least, px in zip(asked, clip_px(stimuli, across), strict=True)
    )
    return width, height


def clip_px(stimuli: Sequence[Stimulus], across: int) -> list[int]:
    """Returns the device pixels that the largest clips need beside each other."""
    return [across * max(s.width_px for s in stimuli), max(s.height_px for s in stimuli)]


def fits(refresh_hz: float | None, frame_rate_hz: float) -> bool:
    """True where the screen shows each frame of the clip equally often."""
    if refresh_hz is None:
        return False
    ratio = refresh_hz / frame_rate_hz
    return round(ratio) >= 1 and abs(ratio / round(ratio) - 1) <= REFRESH_TOLERANCE
