# SPDX-License-Identifier: MIT
"""How strongly a clip is manipulated: the value achieved, else the level asked for."""

from __future__ import annotations

import math
from typing import Any

from verisim.study.server.stimulus_set import Stimulus


def achieved_level(stimulus: Stimulus, factor: str) -> float | None:
    """Returns the achieved value of a factor; None where the clip has none or it is no number."""
    achieved = stimulus.sidecar.get("achieved")
    if isinstance(achieved, dict) and (value := _number(achieved.get(factor))) is not None:
        return value
    return _number(stimulus.factors.get(factor, ""))


def _number(value: Any) -> float | None:
    if isinstance(value, bool) or value is None or value == "":
        return None
    try:
        number = float(value)
    except (TypeError, ValueError):
        return None
    return number if math.isfinite(number) else None
